"""How messages travel: keys, codec, bus, outbox and delivery, tensors; the only home of Zenoh."""
