"""People on the bus: shows the robots, takes words, and owns the log of what people said."""
