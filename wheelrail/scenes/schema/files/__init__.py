"""Files of a scene: TOML, wagons and their ranges, irregularities, examples."""
