"""The simulated robot cell: scene, tasks, expert and the oracle's knowledge.

The only home of MuJoCo, and only `scene`, `cell`, `camera` and `env` need it: the modules
`state`, `skills`, `expert`, `tasks` and `site` import without it.
"""
