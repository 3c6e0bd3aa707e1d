"""A robot behind rosbridge."""
