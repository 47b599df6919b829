# SPDX-License-Identifier: MIT OR Apache-2.0
"""Distances between the nodes of a file. Nodes are numbers here, and `parent` has that of each node but the roots."""


def parents(nodes):
    """The parent of each node that has one, of the nodes of a whole file."""
    return {child: i for i, node in enumerate(nodes) for child in node.children or []}


def path(parent, number):
    """From a node to its root. A wrong file may have nodes in a ring; there the path ends before it repeats itself."""
    found = []
    while number is not None and number not in found:
        found.append(number)
        number = parent.get(number)
    return found


def steps(parent, one, other):
    """How many steps it is from one node to another along the tree. Roots are siblings."""
    own, far = path(parent, one), path(parent, other)
    for up, ancestor in enumerate(far):
        if ancestor in own:
            return own.index(ancestor) + up
    return len(own) + len(far)
