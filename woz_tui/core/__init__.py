"""What every room shares: messages, the driver's contract, the clock, the hub, the wire."""
