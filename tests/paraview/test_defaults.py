# SPDX-License-Identifier: BSD-3-Clause
"""The default of a property in the XML is that of the class: for every proxy of the plugin.

A second proxy of the same class, without the properties that set something, reads what the class
has by itself. Lists, which are added to and cannot be read, are compared by what the class prints.
"""

import glob
import os
import sys
from xml.etree import ElementTree

from paraview import servermanager
from paraview.simple import GetColorTransferFunction  # connects, and so loads the plugin

SETTERS = {"DoubleVectorProperty", "IntVectorProperty", "StringVectorProperty",
           "IdTypeVectorProperty"}


def plugin_proxies():
    """(group, element) of each proxy with a class; the element has the properties of its base."""
    folder = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "xml")
    proxies = {(group.get("name"), proxy.get("name")): proxy
               for name in sorted(glob.glob(os.path.join(folder, "*.xml")))
               for group in ElementTree.parse(name).getroot().iter("ProxyGroup")
               for proxy in group}
    for (group, _), proxy in proxies.items():
        base = proxies.get((proxy.get("base_proxygroup"), proxy.get("base_proxyname")))
        if base is not None:
            proxy.extend(base)
        if proxy.get("class"):
            yield group, proxy


def properties(proxy, verb):
    """(element, noun) of the properties of which the command is "<verb><noun>"."""
    for element in proxy:
        command = element.get("command", "")
        if (element.tag in SETTERS and command.startswith(verb)
                and element.get("information_only") != "1"):
            yield element, command[len(verb):]


def define_reader(proxy, group):
    """A proxy that only reads, in `group`."""
    root = ElementTree.Element("ServerManagerConfiguration")
    parent = ElementTree.SubElement(root, "ProxyGroup", name=group)
    reader = ElementTree.SubElement(
        parent, "Proxy", {"name": proxy.get("name"), "class": proxy.get("class")})
    for element, noun in properties(proxy, "Set"):
        ElementTree.SubElement(reader, element.tag, {
            "name": element.get("name"), "command": "Get" + noun, "information_only": "1"})
    definitions = servermanager.ProxyManager().SMProxyManager.GetProxyDefinitionManager()
    assert definitions.LoadConfigurationXMLFromString(
        ElementTree.tostring(root, encoding="unicode"))


def values(sm_proxy, name):
    sm_property = sm_proxy.GetProperty(name)
    return [sm_property.GetElement(i) for i in range(sm_property.GetNumberOfElements())]


def printed(sm_proxy, noun):
    """The lines about a list."""
    lines = [line.strip() for line in str(sm_proxy.GetClientSideObject()).splitlines()]
    return [line for line in lines if line.startswith(noun)]


def expect_no_looks_of_other_data():
    """A colour map goes by an array's name alone: those of other data keep ParaView's default."""
    default = list(GetColorTransferFunction("An array of the user").RGBPoints)
    for name in ("Force", "Displacement", "Energy", "Stiffness", "Flags", "Error"):
        assert list(GetColorTransferFunction(name).RGBPoints) == default, name


def main():
    manager = servermanager.ProxyManager().SMProxyManager
    compared, wrong = 0, []
    for group, proxy in plugin_proxies():
        name = proxy.get("name")
        define_reader(proxy, "palpate_test_defaults")
        by_class = manager.NewProxy("palpate_test_defaults", name)
        assert by_class, f"the plugin has no class {proxy.get('class')}"
        by_class.UpdateVTKObjects()
        by_class.UpdatePropertyInformation()
        by_xml = manager.NewProxy(group, name)
        by_xml.UpdateVTKObjects()
        defaults = [(element.get("name"), values(by_class, element.get("name")),
                     values(by_xml, element.get("name")))
                    for element, _ in properties(proxy, "Set")]
        for element, noun in properties(proxy, "Add"):
            of_class, of_xml = printed(by_class, noun), printed(by_xml, noun)
            assert of_class, f"{proxy.get('class')} does not print what {noun} has added"
            defaults.append((element.get("name"), of_class, of_xml))
        for key, of_class, of_xml in defaults:
            print(f"{name}.{key}: {of_xml}")
            if of_class != of_xml:
                wrong.append(f"{name}.{key}: {of_xml} in the XML, {of_class} in the class")
        expected = [element.get("name") for element in proxy
                    if element.tag in SETTERS and element.get("information_only") != "1"]
        assert sorted(key for key, _, _ in defaults) == sorted(expected), name
        compared += len(defaults)
        by_class.UnRegister(None)
        by_xml.UnRegister(None)
    assert compared >= 15, compared
    expect_no_looks_of_other_data()
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
