# SPDX-License-Identifier: BSD-3-Clause
"""The default of a property in the XML is that of the class: for every proxy of the plugin.

A second proxy of the same class, without the properties that set something, reads what the class
has by itself.
"""

import glob
import os
import sys
from xml.etree import ElementTree

from paraview import servermanager
from paraview.simple import GetActiveSource  # noqa: F401: connects, and so loads the plugin

SETTERS = {"DoubleVectorProperty", "IntVectorProperty", "StringVectorProperty",
           "IdTypeVectorProperty"}


def plugin_proxies():
    """(group, element) of each proxy with a class."""
    folder = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "xml")
    for name in sorted(glob.glob(os.path.join(folder, "*.xml"))):
        for group in ElementTree.parse(name).getroot().iter("ProxyGroup"):
            for proxy in group:
                if proxy.get("class"):
                    yield group.get("name"), proxy


def settable(proxy):
    for element in proxy:
        command = element.get("command", "")
        if (element.tag in SETTERS and command.startswith("Set")
                and element.get("information_only") != "1"):
            yield element


def define_reader(proxy, group):
    """A proxy that only reads, in `group`."""
    root = ElementTree.Element("ServerManagerConfiguration")
    parent = ElementTree.SubElement(root, "ProxyGroup", name=group)
    reader = ElementTree.SubElement(
        parent, "Proxy", {"name": proxy.get("name"), "class": proxy.get("class")})
    for element in settable(proxy):
        ElementTree.SubElement(reader, element.tag, {
            "name": element.get("name"), "command": "Get" + element.get("command")[len("Set"):],
            "information_only": "1"})
    definitions = servermanager.ProxyManager().SMProxyManager.GetProxyDefinitionManager()
    assert definitions.LoadConfigurationXMLFromString(
        ElementTree.tostring(root, encoding="unicode"))


def values(sm_proxy, name):
    sm_property = sm_proxy.GetProperty(name)
    return [sm_property.GetElement(i) for i in range(sm_property.GetNumberOfElements())]


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
        for element in settable(proxy):
            key = element.get("name")
            of_class, of_xml = values(by_class, key), values(by_xml, key)
            compared += 1
            print(f"{name}.{key}: {of_xml}")
            if of_class != of_xml:
                wrong.append(f"{name}.{key}: {of_xml} in the XML, {of_class} in the class")
        by_class.UnRegister(None)
        by_xml.UnRegister(None)
    assert compared >= 15, compared
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
