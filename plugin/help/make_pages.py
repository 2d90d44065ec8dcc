# SPDX-License-Identifier: BSD-3-Clause
"""Turns the Markdown pages that contents.xml names into those of ParaView's Help window.

They keep their places among each other, so that links and pictures are the same on the web. A link
to the XML of a filter leads to the page that ParaView makes of it, and one to a file that is not in
the Help window becomes text.

Arguments: the folder for the pages, and the program cmark-gfm
"""
import os
import re
import shutil
import struct
import subprocess
import sys
from xml.etree import ElementTree

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
WIDEST = 600  # pixels of the pictures beside each other, so that they fit into the window
TABLE = '<table border="1" cellspacing="0" cellpadding="4">'


def page_of_proxy(path):
    """The name of the page of the properties of the filter in an XML file."""
    return next(f"{group.get('name')}.{proxy.get('name')}.html"
                for group in ElementTree.parse(path).getroot().iter("ProxyGroup")
                for proxy in group if proxy.get("class"))


def anchor(heading):
    """As GitHub makes it."""
    text = re.sub(r"<[^>]*>|&\w+;", "", heading).lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def translate(page, pages, output, cmark):
    source = os.path.join(ROOT, page)
    folder = os.path.dirname(source)
    html = subprocess.run([cmark, "--extension", "table", source], check=True, text=True,
                          encoding="utf-8", stdout=subprocess.PIPE).stdout

    def link(match):
        target, text = match.groups()
        path, hash_sign, place = target.partition("#")
        name = os.path.relpath(os.path.join(folder, path), ROOT)
        if name in pages:
            path = path[:-len(".md")] + ".html"
        elif path.endswith(".xml"):
            path = os.path.relpath(os.path.join(ROOT, page_of_proxy(os.path.join(folder, path))),
                                   folder)
        elif path and not path.startswith("http"):
            return text
        return f'<a href="{path}{hash_sign}{place}">{text}</a>'

    def pictures(match):
        row = match.group()
        widest = WIDEST // max(row.count("<img"), 1)

        def picture(match):
            name = os.path.relpath(os.path.join(folder, match.group(1)), ROOT)
            with open(os.path.join(ROOT, name), "rb") as file:
                width, = struct.unpack(">16xI", file.read(20))
            os.makedirs(os.path.dirname(os.path.join(output, name)), exist_ok=True)
            shutil.copy(os.path.join(ROOT, name), os.path.join(output, name))
            return f'<img src="{match.group(1)}" width="{min(width, widest)}"'

        return re.sub(r'<img src="([^"]*)"', picture, row)

    html = re.sub(r'<a href="([^"]*)">(.*?)</a>', link, html, flags=re.DOTALL)
    html = re.sub(r"<tr>.*?</tr>|<img[^>]*>", pictures, html, flags=re.DOTALL)
    html = re.sub(r"<(h\d)>(.*?)</h", lambda heading: f'<{heading[1]} id="{anchor(heading[2])}">'
                  f'<a name="{anchor(heading[2])}"></a>{heading[2]}</h', html)
    html = html.replace("<table>", TABLE)
    title = re.search(r"<h1[^>]*><a[^>]*></a>(.*)</h1>", html).group(1)
    path = os.path.join(output, page[:-len(".md")] + ".html")
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(f'<html><head><meta charset="utf-8"><title>{title}</title></head>\n'
                   f"<body>\n{html}</body></html>\n")


def main(output, cmark):
    refs = [section.get("ref") for section in
            ElementTree.parse(os.path.join(HERE, "contents.xml")).iter("section")]
    pages = {ref[:-len(".html")] + ".md" for ref in refs if not re.match(r"\w+\.\w+\.html", ref)}
    shutil.rmtree(output, ignore_errors=True)
    for page in sorted(pages):
        translate(page, pages, output, cmark)


main(*sys.argv[1:])
