"""Makes the tracked embryos of this folder, which are synthetic: two ascidians as TrackMate writes them, three neuroblast clones as
ultrack writes them. The sizes and times are of the order of real ones, with noise of segmentation; no animal was measured."""

import random
from pathlib import Path

FOLDER = Path(__file__).parent

#: Mother, larger and smaller daughter, χ of the volumes.
ASCIDIAN = [
    ("A3", "a4.2", "A4.1", 0.02),
    ("B3", "B4.1", "b4.2", 0.05),
    ("B4.1", "B5.1", "B5.2", 0.16),
    ("B5.2", "B6.4", "B6.3", 0.18),
    ("B6.3", "B7.5", "B7.6", 0.62),
]
NEUROBLAST = [
    ("NB0", "NB1", "GMC1", 0.62),
    ("NB1", "NB2", "GMC2", 0.58),
    ("NB2", "NB3", "GMC3", 0.53),
    ("GMC1", "N1", "N2", 0.04),
]


class Cell:
    def __init__(self, name, volume, birth, last, mother):
        self.name, self.volume, self.birth, self.last, self.mother = name, volume, birth, last, mother


def grown(divisions, first, volume, lives, end, rng):
    """The cells from the first one on, mothers before daughters."""
    cells, order = {first: Cell(first, volume, 0, None, None)}, [first]
    daughters = {mother: (larger, smaller, chi) for mother, larger, smaller, chi in divisions}
    for name in order:
        cell = cells[name]
        if name not in daughters:
            cell.last = max(cell.birth, end)
            continue
        larger, smaller, chi = daughters[name]
        cell.last = cell.birth + max(1, round(rng.gauss(lives(name), 0.4)))
        chi += rng.gauss(0, 0.02)
        for daughter, share in ((larger, 0.5 * (1 + chi)), (smaller, 0.5 * (1 - chi))):
            cells[daughter] = Cell(daughter, cell.volume * share, cell.last + 1, None, name)
            order.append(daughter)
    return [cells[name] for name in order]


def radius(volume):
    return (0.2387324146 * volume) ** (1 / 3)


def trackmate(path, seed, minutes, scale):
    rng = random.Random(seed)
    def lives(name):
        return 6 + ("B6" in name) * 2

    cells = [cell for first in ("A3", "B3") for cell in grown(ASCIDIAN, first, scale * 3.59e5, lives, 30, rng)]
    spots, tracks, number, last = [], {"A": [], "B": []}, 1000 + 7 * seed, {}
    for cell in cells:
        for frame in range(cell.birth, cell.last + 1):
            number += rng.randint(1, 9)
            r = radius(cell.volume) * (1 + rng.gauss(0, 0.004))
            place = [round(rng.uniform(0, 140), 3) for _ in range(3)]
            spots.append((frame, number, r, place))
            before = last.get(cell.name) or last.get(cell.mother)
            if before:
                tracks[cell.name[0].upper()].append((before, number))
            last[cell.name] = number
    # Follicle cells, which TrackMate finds and does not link.
    spots += [(frame, number + 10 + k, 5.0, [1.0, 2.0, 3.0]) for k, frame in enumerate((0, 3, 9))]
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<TrackMate version="7.11.1">',
        '  <Model spatialunits="micron" timeunits="min">',
        f'    <AllSpots nspots="{len(spots)}">',
    ]
    for frame in sorted({spot[0] for spot in spots}):
        lines.append(f'      <SpotsInFrame frame="{frame}">')
        for at, number, r, (x, y, z) in spots:
            if at == frame:
                lines.append(
                    f'        <Spot ID="{number}" name="ID{number}" VISIBILITY="1" RADIUS="{r:.3f}" QUALITY="1.0" '
                    f'POSITION_T="{frame * minutes}" POSITION_X="{x}" POSITION_Y="{y}" POSITION_Z="{z}" FRAME="{frame}" />'
                )
        lines.append("      </SpotsInFrame>")
    lines += ["    </AllSpots>", "    <AllTracks>"]
    for track, edges in enumerate(tracks.values()):
        lines.append(f'      <Track name="Track_{track}" TRACK_ID="{track}">')
        lines += [f'        <Edge SPOT_SOURCE_ID="{a}" SPOT_TARGET_ID="{b}" />' for a, b in edges]
        lines.append("      </Track>")
    lines += ["    </AllTracks>", "    <FilteredTracks>"]
    lines += [f'      <TrackID TRACK_ID="{track}" />' for track in range(len(tracks))]
    lines += ["    </FilteredTracks>", "  </Model>", "</TrackMate>", ""]
    (FOLDER / path).write_text("\n".join(lines), encoding="utf-8")


def ultrack(path, seed):
    rng = random.Random(seed)
    cells = grown(NEUROBLAST, "NB0", 5200.0, lambda name: 36 if "GMC" in name else 9, 50, rng)
    ids = {cell.name: k + 1 for k, cell in enumerate(cells)}
    rows = ["track_id,t,z,y,x,id,parent_track_id,parent_id,area"]
    for cell in cells:
        parent = ids.get(cell.mother, -1)
        for frame in range(cell.birth, cell.last + 1, 1 if cell.last - cell.birth < 12 else 4):
            area = round(cell.volume * (1 + rng.gauss(0, 0.02)))
            z, y, x = (round(rng.uniform(0, 60), 1) for _ in range(3))
            rows.append(f"{ids[cell.name]},{frame},{z},{y},{x},{1_000_000 * (frame + 1) + ids[cell.name]},{parent},-1,{area}")
    (FOLDER / path).write_text("\n".join(rows) + "\n", encoding="utf-8")


trackmate("ascidian1.xml", 1, 4.0, 1.0)
trackmate("ascidian2.xml", 2, 5.0, 1.08)
for clone in (1, 2, 3):
    ultrack(f"clone{clone}_tracks.csv", clone)
