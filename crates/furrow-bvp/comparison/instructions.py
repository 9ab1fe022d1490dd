"""Instructions that furrow-bvp and COLNEW take on the test problems of Cash and Mazzia, by valgrind's callgrind.

    cargo build --release --example cash_mazzia_work
    python comparison/instructions.py TARGET/release/examples/cash_mazzia_work colnew.f [TABLE.csv]

COLNEW's source is not part of this repository; see compare.py. Counts are those of the call that solves, from the same line on ten
equal intervals. COLNEW has a tolerance of 1e-6. A case of furrow-bvp counts at equal tolerance, and at equal error: the least number
of instructions, over tolerances from 1e-3 to 1e-7, of a solution at most as far from the reference as COLNEW's. Distances are the
largest of the first component over 1 + |value| at 400 places, half of which follow the layers.
"""

import glob
import os
import statistics
import subprocess
import sys
import tempfile

# In steps of a decade the work at equal error would be a tenth too large.
TOLERANCES = [f"{10 ** (-k / 4):.3g}" for k in range(12, 29)]
# A solution with a larger error is wrong. Cases that COLNEW does not solve are left out.
WRONG = 1e-3


def counted(folder, function, command):
    """The output of a command, and the instructions of every call of a function."""
    out = os.path.join(folder, "count")
    for old in glob.glob(out + "*"):
        os.remove(old)
    options = [f"--toggle-collect={function}", f"--dump-after={function}", f"--callgrind-out-file={out}"]
    run = subprocess.run(["valgrind", "-q", "--tool=callgrind", *options, *command], check=True, capture_output=True, text=True)
    counts = []
    while os.path.exists(part := f"{out}.{len(counts) + 1}"):
        with open(part) as file:
            counts += [int(line.split()[1]) for line in file if line.startswith("totals:")]
    return run.stdout.splitlines(), counts


def build(folder, source, processor):
    """The program that solves the cases by COLNEW, compiled for a processor."""
    objects = [os.path.join(folder, name) for name in ("colnew.o", "problems.o")]
    subprocess.run(["gfortran", "-O3", f"-march={processor}", "-std=legacy", "-w", "-c", source, "-o", objects[0]], check=True)
    problems = os.path.join(os.path.dirname(os.path.abspath(__file__)), "colnew.c")
    subprocess.run(["gcc", "-O3", f"-march={processor}", "-c", problems, "-o", objects[1]], check=True)
    program = os.path.join(folder, "colnew")
    subprocess.run(["gfortran", *objects, "-lblas", "-lm", "-o", program], check=True)
    return program


def error(line, case):
    """The largest error of a line of COLNEW's output, infinite if it has not solved the case."""
    if line.split(",")[2] != "1":
        return float("inf")
    found = map(float, line.split(",")[5].split())
    known = map(float, case.split(",")[3].split())
    return max(abs(value - right) / (1 + abs(right)) for value, right in zip(found, known))


def main():
    furrow, source = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as folder:
        places = os.path.join(folder, "places.csv")
        subprocess.run([furrow, "places", places], check=True, stderr=subprocess.DEVNULL)
        with open(places) as file:
            cases = file.read().splitlines()
        # Valgrind knows no AVX-512.
        program = build(folder, source, "x86-64-v3")
        lines = subprocess.run([program, "1e-6", places], check=True, capture_output=True, text=True).stdout.splitlines()
        cases = [case for case, line in zip(cases, lines, strict=True) if error(line, case) <= WRONG]
        with open(places, "w") as file:
            file.writelines(case + "\n" for case in cases)
        lines, counts = counted(folder, "colnew_", [program, "1e-6", places])
        colnew = [(error(line, case), count, line.split(",")[3]) for line, case, count in zip(lines, cases, counts, strict=True)]
        lines, counts = counted(folder, "cash_mazzia_work::measured", [furrow, places, *TOLERANCES])
    runs = [(float(line.split(",")[3]), count, line.split(",")[4]) for line, count in zip(lines, counts, strict=True)]
    rows, equal_tolerance, equal_error = [], [], []
    for k, case in enumerate(cases):
        of_case = runs[k :: len(cases)]
        theirs, own = colnew[k], of_case[TOLERANCES.index(f"{1e-6:.3g}")]
        cheapest = min((count for off, count, _ in of_case if off <= theirs[0]), default=None)
        rows.append([*case.split(",")[:2], *theirs, *own, cheapest])
        if own[0] <= WRONG:
            equal_tolerance.append(own[1] / theirs[1])
            equal_error.append(cheapest / theirs[1] if cheapest else float("inf"))
    if len(sys.argv) > 3:
        with open(sys.argv[3], "w") as file:
            file.write("problem,epsilon,colnew error,instructions,intervals,furrow error,instructions,intervals,at equal error\n")
            file.writelines(",".join(map(str, row)) + "\n" for row in rows)
    for name, ratios in (("tolerance", equal_tolerance), ("error", equal_error)):
        quarter, middle, upper = statistics.quantiles(ratios)
        print(f"instructions over COLNEW's at equal {name}: median {middle:.2f}, quartiles {quarter:.2f} and {upper:.2f}, "
              f"{min(ratios):.2f} to {max(ratios):.1f}, {len(ratios)} cases")


if __name__ == "__main__":
    main()
