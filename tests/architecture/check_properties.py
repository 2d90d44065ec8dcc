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

UNIT = re.compile(r"\b[Nn]o unit\b|(?:^|[\s(])(?:m|m²|m³|Pa|N|N/m|J|J/m²|s|1/s|m/s²|kg/m³)"
                  r"(?=[\s,;:.)]|$)")
# The groups of which every property is advanced.
ADVANCED = {"Accuracy", "Finer Part", "Log", "Solver"}
# Properties of earlier versions, which are not shown.
OLD_NAMES = {"PalpateRenamedProperty", "PalpateOldToolProperty"}
# More at a time are not taken in. Those that follow a choice are not all there at the same time.
MOST_AT_ONCE = 9


def text_of(element):
    return " ".join(element.findtext("Documentation", "").split())


def is_decorated(element):
    """Whether it is shown for some choice of another property alone."""
    return any(hint.get("mode") == "visibility" for hint in element.iter("PropertyWidgetDecorator"))


def properties_of(proxy, bases):
    """The properties that are shown, by name: those of its base, and then its own."""
    base = bases.get((proxy.get("base_proxygroup"), proxy.get("base_proxyname")))
    properties = {} if base is None else properties_of(base, bases)
    for element in proxy:
        name = element.get("name")
        if element.tag.endswith("Property") and element.tag not in OLD_NAMES:
            # What is said anew of a property of the base adds to what is said there.
            if name in properties:
                element = merged(properties[name], element)
            properties[name] = element
    return properties


def merged(base, own):
    element = ElementTree.Element(base.tag, {**base.attrib, **own.attrib})
    element.extend([*own, *base])
    return element


def faults_of(proxy, bases):
    """What is wrong with a proxy, a line each."""
    if not text_of(proxy):
        yield "no documentation"
    properties = properties_of(proxy, bases)
    # Others are a part of a filter's panel, and have no groups.
    has_panel = proxy.tag == "SourceProxy"
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
        # The panel shows no input, unless it is told to.
        if element.tag == "InputProperty" and not element.get("panel_visibility"):
            continue
        if not has_panel:
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


def bases_of(root):
    """Proxies that others may be derived from, by group and name."""
    return {(group.get("name"), proxy.get("name")): proxy
            for group in root.iter("ProxyGroup") for proxy in group if not proxy.get("class")}


def proxies(root):
    return [element for element in root.iter() if element.tag.endswith("Proxy")
            and element.get("class")]


def check_the_check():
    bad = ElementTree.fromstring("""<P><ProxyGroup name="g"><Proxy name="b">
        <DoubleVectorProperty name="E"><Documentation>It.</Documentation></DoubleVectorProperty>
        </Proxy></ProxyGroup>
        <Proxy class="d" base_proxygroup="g" base_proxyname="b"><Documentation>It.</Documentation>
        <DoubleVectorProperty name="E"><DoubleRangeDomain name="r" /></DoubleVectorProperty></Proxy>
        <SourceProxy class="c"><Documentation>It.</Documentation>
        <DoubleVectorProperty name="A"><DoubleRangeDomain name="r" />
          <Documentation>A length, in minutes per N·m.</Documentation></DoubleVectorProperty>
        <IntVectorProperty name="B" /><IdTypeVectorProperty name="D"><IntRangeDomain name="r" />
          <Documentation>Id.</Documentation></IdTypeVectorProperty>
        <PropertyGroup label="Solver"><Property name="B" /><Property name="C" /></PropertyGroup>
        </SourceProxy></P>""")
    faults = sorted(fault for proxy in proxies(bad) for fault in faults_of(proxy, bases_of(bad)))
    expected = ("A: in 0 property groups", "A: no unit", "B: no documentation", "B: no domain",
                "B: not advanced", "D: in 0 property groups", "D: the panel",
                "E: no unit", "the group Solver has an unknown property C")
    assert len(faults) == len(expected), faults
    assert all(map(str.startswith, faults, expected)), faults


def main():
    check_the_check()
    faults, count = [], 0
    roots = {path: ElementTree.parse(path).getroot()
             for path in sorted(glob.glob(os.path.join(sys.argv[1], "xml", "*.xml")))}
    bases = {key: base for root in roots.values() for key, base in bases_of(root).items()}
    for path, root in roots.items():
        for proxy in proxies(root):
            count += 1
            faults += [f"xml/{os.path.basename(path)}: {fault}"
                       for fault in faults_of(proxy, bases)]
    assert count >= 8, count
    sys.exit("\n".join(faults) or None)


main()
