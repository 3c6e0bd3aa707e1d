"""The qi messaging protocol, in Python alone: NAOqi's wire for machines that libqi has no wheels for."""
