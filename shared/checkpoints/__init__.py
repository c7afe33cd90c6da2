"""The policies that come with the project, so that nothing is trained before a robot moves."""
