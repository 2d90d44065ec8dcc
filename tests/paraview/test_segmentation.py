# SPDX-License-Identifier: BSD-3-Clause
"""The Segmentation Reader: bodies lie as their files say, in eight orientations of four formats,
segments by name, damaged files; and the warning where ParaView's own reader was used.

Of the files in tests/data, segments.seg.nrrd was written by pynrrd 1.1.3 with the keys of 3D
Slicer, and labels.nii.gz by nibabel 5.4, big-endian. The others are written here by hand.
"""

import gzip
import os
import struct

import numpy
from paraview import servermanager
from paraview.modules.vtkRemotingCore import vtkProcessModule
from paraview.simple import (AssignMaterial, Contour, ExtractSubset, OpenDataFile,
                             SegmentationReader, TetrahedralizeLabelMap, TetrahedralizeSurface,
                             Threshold)
from support import (Messages, cell_array, expect_error, expect_silence, fetch, field, places,
                     produce)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject

RANKS = vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()
DATA = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "data")
SIZE = (12, 10, 8)
SPACING = numpy.array([2.0, 2.0, 2.2])  # mm
ORIGIN = numpy.array([12.5, -40.0, 7.0])  # mm, LPS
# The walls are then the faces of voxels, and what is compared is right to rounding.
EXACT = {"Unit": "mm", "Smoothing": 0, "ElementSize": 0.0021}
ROUNDING = 1e-6  # of a length; NIfTI has single precision


def labels():
    """A corner and three arms of unlike lengths: unlike its mirror image."""
    array = numpy.zeros(SIZE, numpy.uint8)
    array[1:4, 1:4, 1:4] = 1
    array[4:10, 1:4, 1:4] = 2
    array[1:4, 4:8, 1:4] = 3
    array[1:4, 1:4, 4:6] = 4
    return array


def turn(axis, degrees):
    """The rotation about x, y or z."""
    matrix = numpy.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = numpy.cos(numpy.radians(degrees)), numpy.sin(numpy.radians(degrees))
    matrix[[i, j, i, j], [i, j, j, i]] = [cosine, cosine, -sine, sine]
    return matrix


# The directions of the axes of voxels, in columns, in LPS.
ORIENTATIONS = {
    "identity": numpy.eye(3),
    "half a turn": numpy.diag([-1.0, -1, 1]),
    "a quarter of a turn": turn(0, 90),
    "oblique": turn(2, 20) @ turn(0, -35),
    "mirrored": numpy.diag([1.0, -1, 1]),
    "mirrored and oblique": turn(1, 15) @ numpy.diag([1.0, 1, -1]),
    "permuted": numpy.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]),
    "permuted and mirrored": numpy.array([[0, -1.0, 0], [-1, 0, 0], [0, 0, -1]]),
}


def vectors(columns):
    return " ".join("(" + ",".join(repr(float(x)) for x in column) + ")" for column in columns)


def write_nrrd(name, array, directions, space="left-posterior-superior", sign=(1, 1, 1)):
    """@param sign What leads from LPS to the space."""
    axes = (numpy.diag(sign) @ directions * SPACING).T
    with open(name, "wb") as file:
        file.write((f"NRRD0004\ntype: unsigned char\ndimension: 3\nspace: {space}\n"
                    f"sizes: {' '.join(map(str, array.shape))}\n"
                    f"space directions: {vectors(axes)}\nencoding: gzip\n"
                    f"space origin: {vectors([sign * ORIGIN])}\n\n").encode())
        file.write(gzip.compress(array.tobytes(order="F")))


def meta_header(array, directions, data):
    matrix = " ".join(repr(float(x)) for x in directions.T.ravel())
    return ("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
            f"CompressedData = False\nTransformMatrix = {matrix}\n"
            f"Offset = {' '.join(map(repr, ORIGIN.tolist()))}\n"
            f"ElementSpacing = {' '.join(map(repr, SPACING.tolist()))}\n"
            f"DimSize = {' '.join(map(str, array.shape))}\nElementType = MET_UCHAR\n"
            f"ElementDataFile = {data}\n")


def write_meta(name, array, directions):
    """.mha: header and voxels; .mhd: the header, beside the voxels."""
    voxels = array.tobytes(order="F")
    apart = name.endswith(".mhd")
    raw = os.path.splitext(name)[0] + ".raw"
    with open(name, "wb") as file:
        file.write(meta_header(array, directions, raw if apart else "LOCAL").encode())
        file.write(b"" if apart else voxels)
    if apart:
        with open(raw, "wb") as file:
            file.write(voxels)


def nifti_bytes(array, directions, dimensions=None, unit=2, scale=1.0):
    """With the sform and floats. @param unit 1: m, 2: mm. @param scale Of lengths."""
    to_ras = numpy.diag([-1, -1, 1])
    axes = scale * (to_ras @ directions * SPACING)
    rows = numpy.column_stack([axes, scale * (to_ras @ ORIGIN)])
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *(dimensions or array.shape), 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 16, 32)
    struct.pack_into("<8f", header, 76, 1, *(scale * SPACING), 1, 1, 1, 1)
    struct.pack_into("<fff", header, 108, 352, 1, 0)
    header[123] = unit
    struct.pack_into("<h", header, 254, 1)
    struct.pack_into("<12f", header, 280, *rows.ravel())
    header[344:348] = b"n+1\0"
    return bytes(header) + array.astype("<f4").tobytes(order="F")


def write_nifti(name, array, directions):
    data = nifti_bytes(array, directions)
    with open(name, "wb") as file:
        file.write(gzip.compress(data) if name.endswith(".gz") else data)


WRITERS = {"a.nrrd": write_nrrd, "a.mha": write_meta, "a.nii": write_nifti,
           "a.nii.gz": write_nifti}


def expected(array, directions, origin=ORIGIN, spacing=SPACING):
    """Of each label the volume (m³) and the centroid (m), as the file has them."""
    result = {}
    for label in numpy.unique(array[array > 0]):
        voxels = numpy.argwhere(array == label)
        middle = origin + (voxels.mean(axis=0) * spacing) @ directions.T
        result[int(label)] = (len(voxels) * numpy.prod(spacing) * 1e-9, middle * 1e-3)
    return result


def of_body(grid):
    """The same of a body of linear tetrahedra."""
    cells = numpy.array([[grid.GetCell(i).GetPointId(k) for k in range(4)]
                         for i in range(grid.GetNumberOfCells())])
    corners = places(grid).astype(float)[cells]
    edges = corners[:, 1:] - corners[:, :1]
    volumes = numpy.linalg.det(edges) / 6
    assert volumes.min() > 0
    regions = cell_array(grid, "RegionId")
    middles = corners.mean(axis=1)
    return {int(label): (volumes[regions == label].sum(),
                         numpy.average(middles[regions == label], axis=0,
                                       weights=volumes[regions == label]))
            for label in numpy.unique(regions)}


def handedness(parts):
    """Of the corner and its arms: positive or negative, m³."""
    middles = numpy.array([parts[label][1] for label in (1, 2, 3, 4)])
    return numpy.linalg.det(middles[1:] - middles[0])


def compare(got, wanted, what):
    assert got.keys() == wanted.keys(), (what, got.keys(), wanted.keys())
    for label, (volume, middle) in wanted.items():
        assert abs(got[label][0] / volume - 1) < 3 * ROUNDING, (what, label, got[label], volume)
        assert numpy.allclose(got[label][1], middle, atol=ROUNDING * 0.1), (what, label, got)


def body_of(name):
    return of_body(fetch(TetrahedralizeLabelMap(Input=SegmentationReader(FileName=name), **EXACT)))


def test_orientations():
    array = labels()
    for orientation, directions in ORIENTATIONS.items():
        wanted = expected(array, directions)
        assert numpy.sign(handedness(wanted)) == numpy.sign(numpy.linalg.det(directions))
        for name, write in WRITERS.items():
            write(name, array, directions)
            what = f"{orientation}, {name}"
            got = expect_silence(lambda name=name: body_of(name))
            compare(got, wanted, what)
            assert abs(handedness(got) / handedness(wanted) - 1) < 1e-4, what


def test_arranged():
    """Where the axes of voxels are permuted, every filter of ParaView finds them in their place."""
    array = labels()
    write_nrrd("permuted.nrrd", array, ORIENTATIONS["permuted and mirrored"])
    image = fetch(SegmentationReader(FileName="permuted.nrrd"))
    matrix = image.GetDirectionMatrix()
    assert [matrix.GetElement(i, j) for i in range(3) for j in range(3)] == [
        1, 0, 0, 0, 1, 0, 0, 0, 1]
    assert image.GetDimensions() == (10, 12, 8)
    got = vtk_to_numpy(image.GetPointData().GetArray("Labels")).reshape(8, 12, 10)
    assert (got.transpose(2, 1, 0) == array[::-1, ::-1, ::-1].transpose(1, 0, 2)).all()


def test_spaces():
    """RAS and LAS are LPS by other names; without a space nobody knows."""
    array, directions = labels(), ORIENTATIONS["oblique"]
    wanted = expected(array, directions)
    for space, sign in (("right-anterior-superior", (-1, -1, 1)), ("LAS", (1, -1, 1))):
        write_nrrd("space.nrrd", array, directions, space, sign)
        compare(expect_silence(lambda: body_of("space.nrrd")), wanted, space)
    write_nrrd("scanner.nrrd", array, directions, "scanner-xyz")
    with Messages() as messages:
        compare(body_of("scanner.nrrd"), wanted, "scanner")
    assert messages.warnings == 1 and "does not say" in messages.text, messages.text
    write_nrrd("left.nrrd", array, directions, "3D-left-handed")
    expect_error(lambda: fetch(SegmentationReader(FileName="left.nrrd")), "left-handed", "mirrored")
    # The sform makes way for the qform of the identity, half a turn about z in RAS; in m.
    data = bytearray(nifti_bytes(array, numpy.eye(3), unit=1, scale=1e-3))
    struct.pack_into("<hh", data, 252, 1, 0)
    struct.pack_into("<6f", data, 256, 0, 0, 1, *(numpy.diag([-1, -1, 1]) @ ORIGIN * 1e-3))
    with open("metres.nii", "wb") as file:
        file.write(data)
    compare(expect_silence(lambda: body_of("metres.nii")), expected(array, numpy.eye(3)), "in m")
    write_nrrd("cm.nrrd", array, directions)
    with open("cm.nrrd", "rb") as file:
        data = file.read()
    with open("cm.nrrd", "wb") as file:
        file.write(data.replace(b"encoding", b'space units: "cm" "cm" "cm"\nencoding', 1))
    with Messages() as messages:
        fetch(SegmentationReader(FileName="cm.nrrd"))
    assert messages.warnings == 1 and "'cm'" in messages.text, messages.text


def test_foreign():
    """Files that other programs wrote."""
    directions = turn(2, 25) @ turn(0, -10) @ numpy.diag([-1, 1, 1])  # in RAS
    to_lps = numpy.diag([-1, -1, 1])
    wanted = expected(labels(), to_lps @ directions, to_lps @ ORIGIN)
    compare(expect_silence(lambda: body_of(os.path.join(DATA, "labels.nii.gz"))), wanted, "nibabel")

    write_meta("apart.mhd", labels(), ORIENTATIONS["permuted"])
    compare(expect_silence(lambda: body_of("apart.mhd")),
            expected(labels(), ORIENTATIONS["permuted"]), "voxels in a file of their own")
    probable = labels() / 7
    with open("probable.nii", "wb") as file:
        file.write(nifti_bytes(probable, numpy.eye(3)))
    image = fetch(SegmentationReader(FileName="probable.nii"))
    values = vtk_to_numpy(image.GetPointData().GetArray("Values")).reshape(SIZE[::-1])
    assert numpy.allclose(values.transpose(2, 1, 0), probable)


def strings(data, name):
    array = data.GetFieldData().GetAbstractArray(name)
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def test_segments():
    """liver is a layer; tumour and cyst are in another one, and tumour has the value of liver."""
    reader_file = os.path.join(DATA, "segments.seg.nrrd")
    reader = SegmentationReader(FileName=reader_file)
    reader.UpdatePipelineInformation()
    assert list(reader.Segments) == ["liver", "tumour", "cyst, small"], reader.Segments
    with Messages() as messages:
        image = fetch(reader)
    assert messages.warnings == 1, messages.text
    for words in ("overlap", "'liver' loses 20 voxels", "176 mm³"):
        assert words in messages.text, messages.text
    assert strings(image, "Segment") == ["liver", "tumour", "cyst, small"]
    assert list(field(image, "SegmentLabel")) == [1, 2, 3]
    assert numpy.allclose(field(image, "SegmentColor")[1], [0.564706, 0.933333, 0.564706])
    assert list(field(image, "SegmentVoxels")) == [135, 20, 8]
    assert list(field(image, "SegmentLost")) == [20, 0, 0]
    counts = numpy.bincount(vtk_to_numpy(image.GetPointData().GetArray("Labels")))
    assert list(counts[1:]) == [115, 20, 8], counts

    reader.Segments = ["liver", "cyst, small"]
    body = TetrahedralizeLabelMap(Input=reader, **EXACT)
    grid = expect_silence(lambda: fetch(body))
    directions = numpy.array([[0, 0, 1.0], [-1, 0, 0], [0, -1, 0]])
    chosen = (labels() > 0).astype(int)
    chosen[6:8, 6:8, 5:7] = 3
    compare(of_body(grid), expected(chosen, directions, numpy.array([5, -7, 11.0])), "segments")
    assert strings(grid, "LabelName") == ["liver", "cyst, small"]
    assert "Label 3 (cyst, small)" in strings(grid, "Report")[0]

    # The names stand for the labels in a table of regions.
    table = ["liver", "Neo-Hookean", "YoungsModulus 5000 PoissonsRatio 0.45",
             "cyst, small", "Neo-Hookean", "YoungsModulus 900 PoissonsRatio 0.45"]
    material = AssignMaterial(Input=body, RegionType="Table", RegionArray="RegionId", Regions=table)
    moduli = cell_array(expect_silence(lambda: fetch(material)), "YoungsModulus")
    assert (moduli == numpy.where(cell_array(grid, "RegionId") == 3, 900, 5000)).all()
    material.Regions = ["spleen"] + table[1:3]
    expect_error(lambda: fetch(material), "spleen", "neither a number", "'cyst, small'")

    reader.Segments = []
    expect_error(lambda: fetch(reader), "none", "'liver'")
    reader.Segments = ["tumour", "spleen"]
    expect_error(lambda: fetch(reader), "'spleen'", "'liver', 'tumour', 'cyst, small'")
    reader.Segments = ["tumour"]
    assert strings(expect_silence(lambda: fetch(reader)), "Segment") == ["tumour"]
    # What is chosen is chosen of another file, too.
    write_segments("other.seg.nrrd", {"Segment0_Name": "tumour", "Segment1_Name": "spleen"})
    reader.FileName = "other.seg.nrrd"
    with Messages() as messages:
        assert strings(fetch(reader), "Segment") == ["tumour"]
    assert "'spleen'" not in messages.text, messages.text
    write_nrrd("plain.nrrd", labels(), numpy.eye(3))
    reader.FileName = "plain.nrrd"
    if list(reader.Segments) == ["tumour"]:
        expect_error(lambda: fetch(reader), "'tumour'", "It has none")
    else:
        # ParaView 6.1 takes names that the new file has not out of the list.
        assert list(reader.Segments) == []
        assert expect_silence(lambda: fetch(reader)).GetNumberOfPoints() == labels().size
    other = SegmentationReader(FileName="plain.nrrd")
    assert expect_silence(lambda: fetch(other)).GetFieldData().GetNumberOfArrays() == 0
    # Before anybody has looked into the file.
    early = SegmentationReader(FileName=reader_file, Segments=["cyst, small"])
    assert strings(expect_silence(lambda: fetch(early)), "Segment") == ["cyst, small"]
    wrong = SegmentationReader(FileName=reader_file, Segments=["cist"])
    expect_error(lambda: fetch(wrong), "'cist'")


def write_segments(name, keys, layers=2):
    """A voxel of 1 and one of 3 in each layer; without layers an image of three dimensions."""
    of_list = (f" {layers}", " none", " list") if layers else ("", "", "")
    with open(name, "wb") as file:
        file.write((f"NRRD0005\ntype: unsigned char\ndimension: {4 if layers else 3}\n"
                    f"space: LPS\nsizes:{of_list[0]} 3 3 3\n"
                    f"space directions:{of_list[1]} (1,0,0) (0,1,0) (0,0,1)\n"
                    f"kinds:{of_list[2]} domain domain domain\n"
                    "encoding: raw\nspace origin: (0,0,0)\n"
                    + "".join(f"{key}:={value}\n" for key, value in keys.items())
                    + "\n").encode())
        values = max(layers, 1)
        file.write(bytes(values * [1]) + bytes(values * [3]) + bytes(values * 25))


def test_keys_of_segments():
    # Files of old: each segment is a layer. Two of one name are told apart.
    write_segments("old.seg.nrrd", {"Segment0_Name": "rib", "Segment1_Name": "rib"})
    with Messages() as messages:
        image = fetch(SegmentationReader(FileName="old.seg.nrrd"))
    assert "'rib' loses 1 voxels" in messages.text, messages.text
    assert "1 voxels (1 mm³ of a file in mm) have a value that belongs to no" in messages.text
    assert strings(image, "Segment") == ["rib", "rib (2)"]
    # The usual file: one layer, and no word of it.
    write_segments("flat.seg.nrrd", {
        "Segment0_Name": "rib", "Segment0_LabelValue": "3", "Segment0_Color": "1 2 red",
        "Segment1_Name": "lung", "Segment1_LabelValue": "1"}, layers=0)
    image = expect_silence(lambda: fetch(SegmentationReader(FileName="flat.seg.nrrd")))
    assert strings(image, "Segment") == ["rib", "lung"]
    assert list(field(image, "SegmentLabel")) == [3, 1]
    assert field(image, "SegmentColor")[0].tolist() == [1, 1, 0.5]
    assert list(vtk_to_numpy(image.GetPointData().GetArray("Labels"))[:3]) == [1, 3, 0]
    for keys, word in (({"Segment0_LabelValue": "one"}, "Segment0_LabelValue"),
                       ({"Segment0_Layer": "7"}, "from 0 to 1"),
                       ({"Segment0_LabelValue": "1", "Segment1_LabelValue": "1",
                         "Segment0_Layer": "0", "Segment1_Layer": "0"}, "the same value"),
                       ({"Another": "1"}, "no segmentation")):
        write_segments("bad.seg.nrrd", keys)
        expect_error(lambda: fetch(SegmentationReader(FileName="bad.seg.nrrd")), word)


def test_errors():
    array = labels()
    write_nrrd("good.nrrd", array, numpy.eye(3))
    write_meta("good.mha", array, numpy.eye(3))
    write_meta("good.mhd", array, numpy.eye(3))
    write_nifti("good.nii", array, numpy.eye(3))
    write_nifti("good.nii.gz", array, numpy.eye(3))
    sheared = numpy.eye(3)
    sheared[0, 1] = 0.3
    write_nrrd("shear.nrrd", array, sheared)
    write_meta("shear.mha", array, sheared)
    write_nifti("shear.nii", array, sheared)
    os.mkfifo("pipe.nrrd")

    def variant(name, change, source):
        with open(source, "rb") as file:
            data = change(file.read())
        with open(name, "wb") as file:
            file.write(data)

    cases = [("shear.nrrd", "right angles"), ("shear.mha", "right angles"),
             ("shear.nii", "right angles"), ("pipe.nrrd", "a pipe"), ("none.mha", "No such file"),
             ("good.raw", "none of .nrrd")]
    for source in ("good.nrrd", "good.mha", "good.nii", "good.nii.gz"):
        variant("cut." + source, lambda data: data[:-len(data) // 8], source)
        variant("head." + source, lambda data: data[:50], source)
        cases += [("cut." + source, "cannot be read"), ("head." + source, "cannot be read")]
    variant("good.raw", lambda data: data[:-1], "good.raw")
    cases.append(("good.mhd", "959 bytes of the 960"))
    # A header that tells of a thousand billion voxels, and one of a billion that are not there.
    for size, words in ((b"10000 10000 10000", "1e+12 values"), (b"900 1000 1000", "cut off")):
        variant("large.mha", lambda data, size=size: data[:-960].replace(b"12 10 8", size),
                "good.mha")
        variant("large.nrrd", lambda data, size=size: data.replace(b"12 10 8", size), "good.nrrd")
        for name in ("large.mha", "large.nrrd"):
            expect_error(lambda name=name: fetch(SegmentationReader(FileName=name)), words)
    with open("large.nii", "wb") as file:
        file.write(nifti_bytes(array, numpy.eye(3), dimensions=(30000, 30000, 30000)))
    cases.append(("large.nii", "values"))

    for name, words in cases:
        reader = SegmentationReader(FileName=name)
        expect_error(lambda reader=reader: fetch(reader), words, name)
        # Once, though it is updated again and a filter follows.
        expect_silence(lambda reader=reader: fetch(
            TetrahedralizeLabelMap(Input=reader, Unit="mm")))
        reader.UpdatePropertyInformation()
        assert reader.GetPropertyValue("ErrorCode") != 0, name


def test_warning():
    """Of what ParaView's own reader leaves out, whatever filter is between."""
    array = labels()
    for orientation, words in (("identity", None), ("half a turn", "turned by 180°"),
                               ("mirrored", "mirror image"), ("oblique", "turned by 4"),
                               ("permuted", "turned by 120°")):
        for name in ("a.nrrd", "a.mha"):
            WRITERS[name](name, array, ORIENTATIONS[orientation])
            image = OpenDataFile(name)
            # Scripts that open such a file have the same reader as ever.
            assert image.SMProxy.GetXMLName() in ("NrrdReader", "MetaImageReader")
            image.UpdatePipeline()
            if image.GetClientSideObject().GetOutputInformation(0).Has(vtkDataObject.DIRECTION()):
                continue  # a version of ParaView that keeps them
            if name == "a.nrrd":
                image = ExtractSubset(Input=image, VOI=[0, 11, 0, 9, 0, 7])
            with Messages() as messages:
                fetch(TetrahedralizeLabelMap(Input=image, **EXACT))
            assert messages.warnings == (1 if words else 0), (name, messages.text)
            assert not words or words in messages.text, messages.text
            assert not words or "Segmentation Reader" in messages.text
    surface = Contour(Input=OpenDataFile("a.mha"), ContourBy=["POINTS", "MetaImage"],
                      Isosurfaces=[0.5])
    with Messages() as messages:
        fetch(TetrahedralizeSurface(Input=surface, Unit="mm"))
    assert messages.warnings == 1 and "turned by 120°" in messages.text, messages.text
    # A contour that leaves out what is left of the directions, in versions that do.
    write_nrrd("oblique.nrrd", array, ORIENTATIONS["oblique"])
    image = SegmentationReader(FileName="oblique.nrrd")
    surface = Contour(Input=image, ContourBy=["POINTS", "Labels"], Isosurfaces=[0.5])
    middle = places(fetch(surface)).mean(axis=0)
    told = places(fetch(Threshold(Input=image, Scalars=["POINTS", "Labels"], LowerThreshold=0.5,
                                  UpperThreshold=4))).mean(axis=0)
    with Messages() as messages:
        fetch(TetrahedralizeSurface(Input=surface, Unit="mm"))
    is_off = numpy.linalg.norm(middle - told) > SPACING[0]
    assert messages.warnings == int(is_off), (messages.text, middle, told)


def test_matrix_that_shears():
    """Whoever has set it."""
    image = fetch(SegmentationReader(FileName="good.nrrd"))
    matrix = image.GetDirectionMatrix()
    matrix.SetElement(0, 1, 0.3)
    image.SetDirectionMatrix(matrix)
    expect_error(lambda: fetch(TetrahedralizeLabelMap(Input=produce(image), **EXACT)),
                 "right angles")


def test_ranks():
    """Each rank has its part, and the body is whole."""
    write_nrrd("ranks.nrrd", labels(), ORIENTATIONS["mirrored and oblique"])
    body = TetrahedralizeLabelMap(Input=SegmentationReader(FileName="ranks.nrrd"), **EXACT)
    compare(of_body(expect_silence(lambda: fetch(body))),
            expected(labels(), ORIENTATIONS["mirrored and oblique"]), "ranks")
    expect_error(lambda: fetch(SegmentationReader(FileName="none.nrrd")), "No such file")


def main():
    if RANKS > 1:
        test_ranks()
        return
    test_orientations()
    test_arranged()
    test_spaces()
    test_foreign()
    test_segments()
    test_keys_of_segments()
    test_errors()
    test_matrix_that_shears()
    test_warning()


main()
