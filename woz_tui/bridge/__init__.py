"""What planners say over a message broker: topics of a robot's own ROS software are played."""
