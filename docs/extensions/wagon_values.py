"""The built-in wagon as `wheelrail wagon` prints it."""

from __future__ import annotations


def wagon_values() -> str:
    """Markdown: all values of the Manchester wagon with their units."""
    from wheelrail.scenes.schema.wagon_file import wagon_toml
    from wheelrail.vehicle.wagon.wagon import Wagon

    return f"```toml\n{wagon_toml(Wagon()).rstrip()}\n```"
