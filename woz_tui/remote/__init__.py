"""From one machine to another: sessions over a network, with a certificate for each name."""
