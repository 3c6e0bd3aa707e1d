"""What two machines of one robot need: certificates, clocks, drivers on another computer."""
