"""Learns from what people said: collect, aggregate, train, gate, publish; round after round."""
