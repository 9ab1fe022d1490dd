"""The founders of C. elegans, grown from the zygote, and exports of the tree."""

from __future__ import annotations

import furrow


def main() -> None:
    """Grows the tree and prints its table."""
    tree = furrow.tree()
    print(tree.table())
    for founder in tree.founders:
        if founder.rounds is not None and founder.observed is not None:
            print(f"{founder.name}: {founder.rounds.mean:.2f} rounds, observed {founder.observed.mean:.2f}")
    graph = tree.to_networkx()
    leaves = [name for name in graph if graph.out_degree(name) == 0]
    print(f"{len(tree)} cells, of which {len(leaves)} are terminal; Newick begins with {tree.newick()[:40]}")


if __name__ == "__main__":
    main()
