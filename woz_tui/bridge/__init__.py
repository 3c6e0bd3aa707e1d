"""Topics of a robot's own ROS software over a message broker: what planners send is played."""
