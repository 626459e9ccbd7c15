// Names of signals as a tree: "gantry.axis0.torque" is a leaf below gantry and axis0.

export interface Leaf {
  readonly name: string;
  readonly unit: string;
}

export interface Branch {
  readonly path: string;
  readonly label: string;
  readonly branches: readonly Branch[];
  readonly leaves: readonly Leaf[];
}

/// A name matches if it, with its unit, contains each word of `search`.
export function matchesSearch(leaf: Leaf, search: string): boolean {
  const text = `${leaf.name} [${leaf.unit}]`.toLowerCase();
  return search
    .toLowerCase()
    .split(/\s+/)
    .every((word) => text.includes(word));
}

export function treeOf(leaves: readonly Leaf[], path = ""): Branch {
  const start = path === "" ? 0 : path.length + 1;
  const own: Leaf[] = [];
  const groups = new Map<string, Leaf[]>();
  for (const leaf of leaves) {
    const dot = leaf.name.indexOf(".", start);
    if (dot < 0) {
      own.push(leaf);
    } else {
      const key = leaf.name.slice(0, dot);
      groups.set(key, [...(groups.get(key) ?? []), leaf]);
    }
  }
  return {
    path,
    label: path.slice(path.lastIndexOf(".") + 1),
    branches: [...groups].map(([key, members]) => treeOf(members, key)),
    leaves: own,
  };
}

export function countLeaves(branch: Branch): number {
  return branch.leaves.length + branch.branches.reduce((sum, each) => sum + countLeaves(each), 0);
}
