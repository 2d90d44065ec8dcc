# SPDX-License-Identifier: BSD-3-Clause
"""Every property of every proxy in xml/ tells a user what it is.

It has documentation, which gives a real number its unit, in SI, or says "no unit" (whole numbers
are ids and counts); a domain, but for lists of numbers, above which the panel would write an empty
range; and a place in one group of the panel, but for the input. What is about how a result is
reached and not about what it is, is advanced, and few properties are not.

Argument: the root of the repository.
"""
import glob
import os
import re
import sys
from xml.etree import ElementTree

UNIT = re.compile(r"\b[Nn]o unit\b|(?:^|[\s(])(?:m|m³|Pa|N|N/m|J|s|1/s|m/s²|kg/m³)(?=[\s,;:.)]|$)")
# The groups of which every property is advanced.
ADVANCED = {"Accuracy", "Finer Part", "Log", "Solver"}
# More at a time are not taken in. Those that follow a choice are not all there at the same time.
MOST_AT_ONCE = 9


def text_of(element):
    return " ".join(element.findtext("Documentation", "").split())


def is_decorated(element):
    """Whether it is shown for some choice of another property alone."""
    return any(hint.get("mode") == "visibility" for hint in element.iter("PropertyWidgetDecorator"))


def faults_of(proxy):
    """What is wrong with a proxy, a line each."""
    if not text_of(proxy):
        yield "no documentation"
    # An old name is not shown.
    properties = {element.get("name"): element for element in proxy
                  if element.tag.endswith("Property") and element.tag != "PalpateRenamedProperty"}
    groups = {}
    for group in proxy.iter("PropertyGroup"):
        for entry in group.iter("Property"):
            groups.setdefault(entry.get("name"), []).append(group.get("label"))
    for name in set(groups) - set(properties):
        yield f"the group {groups[name][0]} has an unknown property {name}"
    for name, element in properties.items():
        text = text_of(element)
        if not text:
            yield f"{name}: no documentation"
        if element.get("information_only") == "1":
            continue
        if element.tag == "DoubleVectorProperty" and not UNIT.search(text):
            yield f"{name}: no unit; write it in SI or 'no unit'"
        if element.tag == "IdTypeVectorProperty":
            yield f"{name}: the panel shows no IdTypeVectorProperty; an IntVectorProperty does"
        if (element.tag != "Property"  # A command has no value.
                and not any(child.tag.endswith("Domain") for child in element)
                and element.get("repeat_command") != "1"):
            yield f"{name}: no domain"
        if name == "Input":
            continue
        if len(groups.get(name, ())) != 1:
            yield f"{name}: in {len(groups.get(name, ()))} property groups, not in one"
        elif groups[name][0] in ADVANCED and element.get("panel_visibility") != "advanced":
            yield f"{name}: not advanced, in the group {groups[name][0]}"
    basic = [name for name, element in properties.items()
             if name in groups and element.tag != "Property"
             and element.get("panel_visibility") != "advanced"
             and not is_decorated(element)]
    if len(basic) > MOST_AT_ONCE:
        yield f"{len(basic)} properties that are not advanced, more than {MOST_AT_ONCE}: {basic}"


def proxies(root):
    return [element for element in root.iter() if element.tag.endswith("Proxy")
            and element.get("class")]


def check_the_check():
    bad = ElementTree.fromstring("""<P><SourceProxy class="c"><Documentation>It.</Documentation>
        <DoubleVectorProperty name="A"><DoubleRangeDomain name="r" />
          <Documentation>A length, in minutes per N·m.</Documentation></DoubleVectorProperty>
        <IntVectorProperty name="B" /><IdTypeVectorProperty name="D"><IntRangeDomain name="r" />
          <Documentation>Id.</Documentation></IdTypeVectorProperty>
        <PropertyGroup label="Solver"><Property name="B" /><Property name="C" /></PropertyGroup>
        </SourceProxy></P>""")
    faults = sorted(fault for proxy in proxies(bad) for fault in faults_of(proxy))
    expected = ("A: in 0 property groups", "A: no unit", "B: no documentation", "B: no domain",
                "B: not advanced", "D: in 0 property groups", "D: the panel",
                "the group Solver has an unknown property C")
    assert len(faults) == len(expected), faults
    assert all(map(str.startswith, faults, expected)), faults


def main():
    check_the_check()
    faults, count = [], 0
    for path in sorted(glob.glob(os.path.join(sys.argv[1], "xml", "*.xml"))):
        for proxy in proxies(ElementTree.parse(path).getroot()):
            count += 1
            faults += [f"xml/{os.path.basename(path)}: {fault}" for fault in faults_of(proxy)]
    assert count >= 8, count
    sys.exit("\n".join(faults) or None)


main()
