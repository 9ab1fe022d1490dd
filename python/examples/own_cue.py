"""How a division depends on the position of a custom cue."""

from __future__ import annotations

import numpy as np

import furrow


def main() -> None:
    """Moves a band of stiffer cortex along the cell and prints χ."""
    places = np.linspace(0.40, 0.50, 11)
    cues = [f"kappa:u0={u0:.3f},omega=0.0577,amplitude=0.1" for u0 in places]
    found = furrow.sweep(axes={"cue": cues}, r0=4.0)
    for u0, chi in zip(places, found["chi"], strict=True):
        print(f"u0 = {u0:.2f}: χ = {chi:.3f}")
    try:
        furrow.Cell(r0=4.0, cue="kappa:u0=0.465,omega=-1,amplitude=0.1")
    except furrow.InputError as error:
        print(f"{error.field} = {error.value}, but must be {error.allowed}")


if __name__ == "__main__":
    main()
