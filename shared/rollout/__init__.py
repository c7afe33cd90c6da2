"""The hierarchical rollout: two rates, when to replan, what an override does. No bus, no MuJoCo."""
