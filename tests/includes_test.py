#!/usr/bin/env python3
"""Every source includes what it uses of the headers that are precompiled.

    tests/includes_test.py ROOT

With precompiled headers, and several sources at a time, the compiler does not
notice a missing include. This looks at each source alone: if it uses a name of
HEADERS, then the source, or a header of the project that it includes, includes
a header that has the name.

Prints `file: what is missing` for each name without its header and exits 1.
"""

import pathlib
import re
import sys

# These bring std::move(), std::pair and std::size_t in every library.
ANY = r"utility|cstddef|vector|string|map|set|memory|functional|algorithm|array"
# The pattern of the headers that have the names, and that of the names.
HEADERS = {
    r"vector": r"std::vector\b",
    r"string|sstream": r"std::(string|to_string|stod|stoi)\b",
    r"map": r"std::(multi)?map\b",
    r"set": r"std::(multi)?set\b",
    r"memory": r"std::((unique|shared|weak)_ptr|make_(unique|shared))\b",
    r"functional": r"std::(function|ref|cref|greater|less|plus|hash)\b",
    r"sstream": r"std::[io]?stringstream\b",
    r"limits": r"std::numeric_limits\b",
    r"complex": r"std::(complex|polar|conj|norm|arg)\b",
    r"algorithm": r"std::((stable_|partial_)?sort|min|max|clamp|copy|fill|find|"
    r"find_if|(any|all|none)_of|(lower|upper)_bound|count(_if)?|reverse|rotate|"
    r"nth_element|unique|transform|(min|max|minmax)_element|remove_if|equal|"
    r"is_sorted|set_difference|binary_search|mismatch|replace)\b",
    r"cmath": r"std::(sqrt|cbrt|hypot|(a?(sin|cos|tan)h?)|atan2|exp|expm1|exp2|"
    r"log|log2|log10|log1p|pow|fabs|fmod|is(finite|nan|inf)|floor|ceil|l?round|"
    r"[lt]gamma|erfc?|remainder|copysign|nextafter|ldexp|frexp)\b",
    ANY: r"std::(size_t|ptrdiff_t|byte|move|pair|swap|exchange|forward|make_pair)\b",
    r"Eigen/\w+|unsupported/Eigen/\w+|ceres/\w+\.h|.*pybind11/eigen\.h":
        r"\bEigen::|\b(Complex)?(Matrix|Vector)\b",
    r"glog/logging\.h": r"\b(D?CHECK(_[A-Z]{2})?|D?LOG|VLOG)\(",
}


def read(path):
    """Returns the includes of a file, and its code without comments and strings."""
    text = path.read_text(encoding="utf-8")
    includes = re.findall(r'#include [<"]([^>"]+)[>"]', text)
    code = re.sub(r"//.*", "", text)
    code = re.sub(r'"(\\.|[^"\\\n])*"', '""', code)
    return includes, code


def reached(path, files):
    """Returns all that a file includes, itself or by the project's headers."""
    found = set()
    waiting = [path]
    while waiting:
        for name in files[waiting.pop()][0]:
            if name not in found:
                found.add(name)
                if name in files:
                    waiting.append(name)
    return found


def main():
    root = pathlib.Path(sys.argv[1])
    files = {}
    for folder in "pinode", "apps", "tests":
        for path in (root / folder).rglob("*"):
            in_fixture = "_fixture" in path.relative_to(root).parts[1]
            if path.suffix in (".cc", ".h", ".inc") and not in_fixture:
                files[path.relative_to(root).as_posix()] = read(path)
    sources = [path for path in files if path.endswith(".cc")]
    missing = 0
    for path in sorted(sources):
        includes = reached(path, files)
        for headers, names in HEADERS.items():
            use = re.search(names, files[path][1])
            if use and not any(re.fullmatch(headers, i) for i in includes):
                header = re.sub(r"\|.*", "", headers)
                print(f"{path}: uses {use[0]} and does not include <{header}>")
                missing += 1
    print(f"{len(sources)} sources, {missing} includes missing")
    sys.exit(missing > 0 or not sources)


if __name__ == "__main__":
    main()
