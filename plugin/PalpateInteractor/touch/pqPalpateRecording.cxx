// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateRecording.h"

#include <QFileInfo>
#include <exception>

#include "haptic/servo/servo.h"

namespace
{
QString FreeName(const QString& name)
{
  const QFileInfo file(name);
  const QString ending = file.suffix().isEmpty() ? QString() : "." + file.suffix();
  QString free = name;
  for (int number = 2; QFileInfo::exists(free); ++number)
  {
    free = QString("%1/%2-%3%4")
             .arg(file.path(), file.completeBaseName(), QString::number(number), ending);
  }
  return free;
}
}

pqPalpateRecording::pqPalpateRecording(const QString& name)
  : File(FreeName(name))
  , Recorder(this->File.toStdString())
{
}

void pqPalpateRecording::Start(const palpate::RecordedSetup& setup, palpate::Servo& servo)
{
  this->Recorder.start(setup);
  servo.set_recording(this->Recorder.ring());
}

QString pqPalpateRecording::Close()
{
  try
  {
    this->Recorder.close();
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return this->GetDropped() > 0
    ? QString("%1 ticks are missing: the disk was too slow, or full.").arg(this->GetDropped())
    : QString();
}
