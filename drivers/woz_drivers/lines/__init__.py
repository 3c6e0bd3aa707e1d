"""Lines to devices, kept open for several drivers: serial ports, WebSockets, addresses."""
