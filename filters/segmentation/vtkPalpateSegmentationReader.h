// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkPalpateSegmentationReader
 * @brief   reads a segmented image with its directions and its segments
 *
 * It reads NRRD, MetaImage and NIfTI. Places are in LPS, in the unit of the file. The voxels are
 * reordered so that their axes point as nearly along x, y and z as they can. The remaining
 * directions of an oblique image are the direction matrix of the output.
 *
 * Output: an image with the point array `Labels` (int), or where there are values that are not
 * whole numbers to within 0.001, `Values` (double). Where the file tells of segments, the field
 * arrays `Segment` (string), `SegmentLabel` (int), `SegmentColor` (3 components), `SegmentVoxels`
 * (double), the voxels that the file gives it, and `SegmentLost` (double), how many of them have
 * the label of a later segment, with a value for each that is chosen.
 *
 * Every rank reads the file, and has the part of it that it is asked for.
 */
#pragma once

#include <map>
#include <string>
#include <vector>

#include "PalpateSegmentationModule.h"
#include "vtkImageAlgorithm.h"
#include "vtkNew.h"

class vtkDataArraySelection;
struct vtkPalpateSegment;

class PALPATESEGMENTATION_EXPORT vtkPalpateSegmentationReader : public vtkImageAlgorithm
{
public:
  static vtkPalpateSegmentationReader* New();
  vtkTypeMacro(vtkPalpateSegmentationReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The file.
  vtkSetStdStringFromCharMacro(FileName);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}

  ///@{
  /// Whether the segments are read, by name. If no segment is named, all are read; otherwise
  /// segments that are not named are not read.
  void AddSegment(const char* name, int isRead);
  void ClearSegments();
  ///@}

  /// The segments of the file, and whether they are read.
  vtkDataArraySelection* GetSegments();

protected:
  vtkPalpateSegmentationReader();
  ~vtkPalpateSegmentationReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateSegmentationReader(const vtkPalpateSegmentationReader&) = delete;
  void operator=(const vtkPalpateSegmentationReader&) = delete;

  void Read(vtkImageData* output, bool tells);
  bool IsRead(const std::string& segment) const;
  /// Whether each of the segments is read.
  std::vector<char> Choose(const std::vector<vtkPalpateSegment>& segments) const;

  std::string FileName;
  std::map<std::string, bool> Chosen; ///< what was said of segments, by name
  vtkNew<vtkDataArraySelection> Segments;
  /// The last message, which is not repeated: the executive runs a reader without an image again at
  /// each update.
  std::string Failure;
  vtkMTimeType FailureTime = 0;
};
