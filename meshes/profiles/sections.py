"""Sections of a profile file: runs of points between lines of text, of which one is used."""

from __future__ import annotations

import numpy as np

from wheelrail.meshes.profiles.formats import MIN_POINTS, NUMBER, ProfileError, RawProfile, shortened

JUMP = 5e-3  # m, distance of the ends of two sections; closer runs of points belong to one


def single_section(raw: RawProfile, number: int | None) -> RawProfile:
    """The points of one section.

    Parameters:
        raw: points of the whole file.
        number: of the section, from 1; None for a file with one section.

    Runs of fewer than 10 points beside a section are left out. Raises ProfileError for text within a section, a file
    with several sections without number, and a section that does not exist.
    """
    steps = np.hypot(*np.diff(raw.points, axis=0).T)
    ends = np.flatnonzero((np.diff(raw.lines) > 1) & (steps > JUMP)) + 1
    runs = np.split(np.arange(len(raw.points)), ends)
    sections = [run for run in runs if len(run) >= MIN_POINTS] or [np.arange(len(raw.points))]
    first = [int(raw.lines[section[0]]) for section in sections if len(section)]
    if number is not None and not 1 <= number <= len(sections):
        raise ProfileError(raw.path, first[0], f"section {number} of {len(sections)}", f"1 to {len(sections)}")
    if number is None and len(sections) > 1:
        lines = ", ".join(map(str, first))
        raise ProfileError(
            raw.path, first[1], f"{len(sections)} sections, from lines {lines}", f"section = 1 to {len(sections)}"
        )
    chosen = sections[(number or 1) - 1]
    lines_of = raw.lines[chosen]
    for line, text in raw.text:
        if len(chosen) and lines_of[0] < line < lines_of[-1]:
            raise ProfileError(raw.path, line, shortened(text), "2 or more finite numbers")
    unused = len(raw.points) - sum(map(len, sections))
    remarks = [f"{unused} points beside the section are left out"] if unused else []
    if len(sections) > 1:
        remarks.append(f"section {number} of {len(sections)}, from line {lines_of[0]}")
    if broken := [
        (line, text) for line, text in raw.text if len(chosen) and line > lines_of[-1] and NUMBER.match(text)
    ][:1]:
        raise ProfileError(raw.path, broken[0][0], shortened(broken[0][1]), "2 or more finite numbers")
    if after := [line for line, _ in raw.text if len(chosen) and line > lines_of[-1]]:
        remarks.append(f"text from line {after[0]} is left out")
    return raw.chosen(chosen, *remarks)
