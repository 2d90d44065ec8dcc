// SPDX-License-Identifier: BSD-3-Clause
/// The recording of a servo loop that the dock runs.
#pragma once

#include <QString>

#include "haptic/recording/recorder.h"

namespace palpate
{
class Servo;
}

class pqPalpateRecording
{
public:
  /// @param name The name of the file. Where there is such a file already, the name gets a number:
  ///   run-2.csv, run-3.csv, …
  /// @throws palpate::InputError the file cannot be made.
  explicit pqPalpateRecording(const QString& name);

  /// Records every tick from now on.
  void Start(const palpate::RecordedSetup& setup, palpate::Servo& servo);
  /// @return Why the recording is not complete; empty: it is.
  QString Close();

  const QString& GetFile() const { return this->File; }
  quint64 GetWritten() const { return this->Recorder.written(); }
  quint64 GetDropped() const { return this->Recorder.dropped(); }

private:
  QString File;
  palpate::Recorder Recorder;
};
