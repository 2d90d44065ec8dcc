// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateDevices.h"

#include <cmath>
#include <exception>
#include <utility>

#include "haptic/transport/open_device.h"
#include "haptic/transport/simulated_board.h"
#include "pqRenderView.h"
#include "vtkCamera.h"
#include "vtkSMRenderViewProxy.h"

const char* const pqPalpateMouseDevice = "mouse";
const char* const pqPalpateHandDevice = "hand";

QVector<pqPalpateDeviceName> pqPalpateListDevices()
{
  QVector<pqPalpateDeviceName> names;
  names.push_back({ pqPalpateMouseDevice, "Mouse", {}, false });
  names.push_back({ pqPalpateHandDevice, "Simulated hand", {}, false });
  try
  {
    for (const palpate::ListedDevice& device : palpate::list_devices())
    {
      if (device.known)
      {
        names.push_back({ QString::fromStdString(device.info.path),
          QString::fromStdString(palpate::to_string(device.info)),
          QString::fromStdString(device.fault),
          device.specification && device.specification->num_buttons > 0 });
      }
    }
  }
  catch (const std::exception& error)
  {
    names.push_back({ {}, "Other devices", error.what(), false });
  }
  return names;
}

pqPalpateDevice pqPalpateSimulatedDevice(
  const std::shared_ptr<palpate::Clock>& clock, std::shared_ptr<palpate::Motion> motion)
{
  palpate::BoardOptions options;
  // With a unit this small, the mouse places the tool exactly on the surface that is seen.
  options.feature.position_unit_nm = 100;
  options.feature.num_buttons = 2;
  auto board = std::make_unique<palpate::SimulatedBoard>(clock, std::move(motion), options);
  pqPalpateDevice device;
  device.Setup.device = "simulated";
  device.Setup.profile = palpate::ProfileKind::palpate_report;
  device.Setup.feature = board->feature();
  // The device has no motor that could move a hand. So the tool does not let go however late the
  // loop is.
  device.Setup.options.release_after = std::chrono::hours(1);
  device.Profile = palpate::make_profile(device.Setup.profile, device.Setup.feature);
  device.Transport = std::move(board);
  return device;
}

std::shared_ptr<palpate::Motion> pqPalpateHandMotion(double depth)
{
  return std::make_shared<palpate::ScriptedMotion>(
    [depth](palpate::Time time)
    {
      constexpr double turn = 2 * 3.14159265358979323846; // a second
      const double angle = turn * palpate::seconds(time);
      const double part = 0.5 * (1 - std::cos(angle / 4));
      const double aside = 0.4 * depth * part;
      palpate::Motion::Pose pose;
      pose.position =
        palpate::Vec3(aside * std::cos(angle), aside * std::sin(angle), -depth * part);
      return pose;
    });
}

palpate::Mat3 pqPalpateAxesOfDevice(pqRenderView* view)
{
  palpate::Vec3 towards = palpate::Vec3::UnitZ();
  palpate::Vec3 up = palpate::Vec3::UnitY();
  if (view)
  {
    vtkCamera* camera = view->getRenderViewProxy()->GetActiveCamera();
    towards = -palpate::Vec3(camera->GetDirectionOfProjection());
    const palpate::Vec3 viewUp(camera->GetViewUp());
    up = (viewUp - viewUp.dot(towards) * towards).normalized();
  }
  palpate::Mat3 axes;
  axes << towards, up.cross(towards), up;
  return axes;
}

pqPalpateDevice pqPalpateOpenDevice(const QString& path)
{
  palpate::OpenedDevice opened = palpate::open_device(path.toStdString());
  pqPalpateDevice device;
  device.Transport = std::move(opened.transport);
  device.Profile = std::move(opened.profile);
  device.Setup.device = palpate::to_string(opened.info);
  device.Setup.profile = opened.kind;
  device.Setup.feature = opened.feature;
  return device;
}
