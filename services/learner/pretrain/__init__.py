"""Makes the demonstrations and trains both levels, before the loop begins (`hld pretrain`)."""
