// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateToolView.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "haptic/touching/pressing_range.h"
#include "vtkArrowSource.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkFloatArray.h"
#include "vtkGlyph3D.h"
#include "vtkMatrix4x4.h"
#include "vtkPVRenderView.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSmartPointer.h"
#include "vtkSphereSource.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"
#include "vtkTrivialProducer.h"
#include "vtkTubeFilter.h"

namespace
{
/// Sizes as shares of the body's diagonal.
constexpr double ToolRadius = 0.012;
constexpr double LongestArrow = 0.4;
/// The arrow is at least so long, so that the direction of a small force is visible too.
constexpr double ShortestArrow = 0.08;
constexpr double NodeRadius = 0.008;
constexpr double RimRadius = 0.012;
constexpr double MouthRadius = 0.003;

constexpr int TextSize = 14;
/// The place of the text at the top, as a share of the height of the view.
constexpr double TextPlace = 0.98;
/// The size of the numbers beside the tool, and their distance from its middle, pixels.
constexpr int NumbersSize = 18;
constexpr double NumbersAside = 45;
/// A force below this is shown with one more digit, N.
constexpr double SmallForce = 0.1;
/// The arrow points at the person or away where the cosine of its angle to the line of sight is
/// above this.
constexpr double EndOn = 0.94;

/// An offset of depth that brings an actor to the front, so that a force that points into the body
/// is visible too.
constexpr double ToFront = -66000;
/// An offset of depth that puts a dot in front of its rim, but behind whatever is in front of both.
constexpr double ToRim = -20000;
/// An offset of depth that puts the veil in front of the surface on which it lies.
constexpr double BeforeBody = -30;

double ToolColour[3] = { 0.95, 0.75, 0.1 };
/// The colour of the force, as in the pictures of the pages. Neither tissue nor pressure has it.
double ForceColour[3] = { 0.05, 0.55, 0.25 };
double MouseColour[3] = { 0.1, 0.35, 0.9 };
constexpr double ToolOpacity = 0.35;
double MouthColour[3] = { 0.35, 0, 0.05 };
double VeilColour[3] = { 0.8, 0.8, 0.8 };
constexpr double VeilOpacity = 0.75;
/// The part of a colour that does not depend on the light.
constexpr double AmbientShare = 0.3;

/// Sets dark letters on a light box with an edge, which are legible on each background.
void SetStyle(vtkTextActor* text, int size)
{
  vtkTextProperty* style = text->GetTextProperty();
  style->SetFontSize(size);
  style->SetColor(0, 0, 0);
  style->SetBackgroundColor(1, 1, 0.85);
  style->SetBackgroundOpacity(0.9);
  style->FrameOn();
  style->SetFrameColor(0.3, 0.3, 0.3);
  text->PickableOff();
  text->VisibilityOff();
}

/// @param towards Cosine of the angle between the force and the way to the person.
/// @param beyond What is said of a force that is extrapolated.
std::string InNumbers(const palpate::Contact& contact, double force, double depth, double towards,
  const std::string& beyond)
{
  char text[160];
  const char* way = towards > EndOn ? " towards you" : towards < -EndOn ? " away from you" : "";
  const std::string where = contact.support == palpate::Support::marked ? "\n in a marked region "
    : contact.support == palpate::Support::extrapolated                 ? "\n " + beyond + " "
                                                                        : std::string();
  const int digits = force < SmallForce ? 3 : 2;
  if (contact.status == palpate::ContactStatus::cutting)
  {
    std::snprintf(text, sizeof text, " %.*f N%s \n %.2f cm² open ", digits, force, way,
      1e4 * contact.torn_area);
    return text;
  }
  const bool presses = contact.status == palpate::ContactStatus::pressing;
  std::snprintf(text, sizeof text, " %.*f N%s \n %.1f mm %s %s", digits, force, way, 1e3 * depth,
    presses ? "deep" : "moved", where.c_str());
  return text;
}

// Draws real spheres, because Mesa's llvmpipe does not draw points as spheres at all.
void ShowSpheres(
  vtkActor* actor, vtkPolyData* places, double radius, double brightness, double offset)
{
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(radius);
  vtkNew<vtkGlyph3D> spheres;
  spheres->SetInputData(places);
  spheres->SetSourceConnection(sphere->GetOutputPort());
  spheres->ScalingOff();
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(spheres->GetOutputPort());
  mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(0, offset);
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(brightness, brightness, brightness);
  actor->GetProperty()->LightingOff();
}

void SetMapper(vtkActor* actor, vtkAlgorithmOutput* output, double offset)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(output);
  mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(0, offset);
  actor->SetMapper(mapper);
  // With the offset all depths are the same, so that the inner side must not be drawn.
  actor->GetProperty()->BackfaceCullingOn();
}

void SetPolyData(vtkActor* actor, vtkPolyData* data, double offset)
{
  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(data);
  SetMapper(actor, producer->GetOutputPort(), offset);
}
}

pqPalpateToolView::pqPalpateToolView(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space,
  const palpate::Touchable& body, const std::vector<char>& pressable, double largestForce,
  const char* beyond)
  : Beyond(beyond)
{
  palpate::Vec3 low = space.surface.points.front();
  palpate::Vec3 high = low;
  for (const palpate::Vec3& point : space.surface.points)
  {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double size = (high - low).norm();

  vtkNew<vtkPoints> points;
  const palpate::RigidTool* rigid = nullptr;
  for (const palpate::TouchToolSpace& toolSpace : space.tool_spaces)
  {
    const palpate::InteractionSpec& interaction = toolSpace.setup.interaction;
    if (interaction.presses())
    {
      rigid = &interaction.tool;
    }
    else
    {
      points->InsertNextPoint(interaction.material_point.data());
    }
  }
  this->ArrowScale = largestForce > 0 ? LongestArrow * size / largestForce : 0;
  this->ShortestArrow = ::ShortestArrow * size;

  this->MakeNodes(points, size);
  if (!space.stages.empty())
  {
    this->MakeMouth(space.surface, size);
  }

  if (rigid)
  {
    this->MakeRigidTool(*rigid);
    this->MakeVeil(space.surface, pressable);
  }
  else
  {
    const double radius = std::max(ToolRadius * size, body.largest_tip_radius());
    this->MakeTip(radius);
    this->BladeScale = ToolRadius * size / radius;
  }
  this->MakeActors(view);
}

pqPalpateToolView::pqPalpateToolView(
  vtkSMRenderViewProxy* view, const palpate::Vec3& place, double size, double largestForce)
  : ArrowScale(largestForce > 0 ? LongestArrow * size / largestForce : 0)
  , ShortestArrow(::ShortestArrow * size)
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(place.data());
  this->MakeNodes(points, size);
  this->MakeTip(ToolRadius * size);
  this->MakeActors(view);
}

void pqPalpateToolView::MakeNodes(vtkPoints* places, double size)
{
  vtkNew<vtkPolyData> nodes;
  nodes->SetPoints(places);
  ShowSpheres(this->Rims, nodes, RimRadius * size, 1, 0);
  ShowSpheres(this->Nodes, nodes, NodeRadius * size, 0, ToRim);
}

void pqPalpateToolView::MakeActors(vtkSMRenderViewProxy* view)
{
  vtkNew<vtkArrowSource> arrow;
  arrow->SetTipResolution(20);
  arrow->SetShaftResolution(16);
  SetMapper(this->Arrow, arrow->GetOutputPort(), ToFront);
  this->Arrow->GetProperty()->SetColor(ForceColour);
  this->Arrow->GetProperty()->SetAmbient(AmbientShare);

  if (auto* client = vtkPVRenderView::SafeDownCast(view->GetClientSideObject()))
  {
    this->Renderer = client->GetNonCompositedRenderer();
  }
  for (vtkActor* actor : this->GetActors())
  {
    actor->PickableOff();
    if (this->Renderer)
    {
      this->Renderer->AddActor(actor);
    }
  }
  this->Tool->VisibilityOff();
  this->Arrow->VisibilityOff();

  SetStyle(this->Text, TextSize);
  vtkTextProperty* style = this->Text->GetTextProperty();
  style->SetJustificationToCentered();
  style->SetVerticalJustificationToTop();
  this->Text->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  this->Text->SetPosition(0.5, TextPlace);
  // The numbers follow when the camera moves.
  SetStyle(this->Numbers, NumbersSize);
  this->Numbers->GetTextProperty()->BoldOn();
  this->Numbers->GetTextProperty()->SetVerticalJustificationToCentered();
  this->NumbersPlace->SetCoordinateSystemToWorld();
  this->Numbers->GetPositionCoordinate()->SetCoordinateSystemToViewport();
  this->Numbers->GetPositionCoordinate()->SetReferenceCoordinate(this->NumbersPlace);
  if (this->Renderer)
  {
    this->Renderer->AddViewProp(this->Text);
    this->Renderer->AddViewProp(this->Numbers);
  }
}

void pqPalpateToolView::MakeTip(double radius)
{
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(radius);
  sphere->SetThetaResolution(24);
  sphere->SetPhiResolution(16);
  SetMapper(this->Tool, sphere->GetOutputPort(), ToFront);
  this->Tool->GetProperty()->SetColor(ToolColour);
  this->Veil->VisibilityOff();
}

void pqPalpateToolView::MakeRigidTool(const palpate::RigidTool& tool)
{
  SetPolyData(this->Tool, vtkPalpateToolSurface(tool), 0);
  this->Poses = palpate::pose_of(tool);
  this->Tool->GetProperty()->SetColor(ToolColour);
  this->Tool->GetProperty()->SetOpacity(ToolOpacity);
}

void pqPalpateToolView::MakeMouth(const palpate::Surface& surface, double size)
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  for (const auto& [a, b] : palpate::mouth_of_cut(surface))
  {
    lines->InsertNextCell({ points->InsertNextPoint(a.data()), points->InsertNextPoint(b.data()) });
  }
  vtkNew<vtkPolyData> mouth;
  mouth->SetPoints(points);
  mouth->SetLines(lines);
  // Tubes are thicker than what the body moves there when it is pulled a little.
  vtkNew<vtkTubeFilter> tubes;
  tubes->SetInputData(mouth);
  tubes->SetRadius(MouthRadius * size);
  tubes->SetNumberOfSides(8);
  SetMapper(this->Mouth, tubes->GetOutputPort(), BeforeBody);
  this->Mouth->GetProperty()->SetColor(MouthColour);
  this->Mouth->GetProperty()->LightingOff();
}

void pqPalpateToolView::MakeVeil(
  const palpate::Surface& surface, const std::vector<char>& pressable)
{
  std::vector<std::array<palpate::Index, 3>> veiled;
  for (const auto& triangle : surface.triangles)
  {
    const bool canPress = std::all_of(triangle.begin(), triangle.end(),
      [&](palpate::Index point) { return pressable[static_cast<std::size_t>(point)] != 0; });
    if (!canPress)
    {
      veiled.push_back(triangle);
    }
  }
  const vtkSmartPointer<vtkPolyData> veil = vtkPalpateTriangles(surface.points, veiled);
  vtkNew<vtkFloatArray> normals;
  normals->SetNumberOfComponents(3);
  for (const palpate::Vec3& normal : palpate::point_normals(surface))
  {
    normals->InsertNextTuple(normal.data());
  }
  veil->GetPointData()->SetNormals(normals);
  SetPolyData(this->Veil, veil, BeforeBody);
  this->Veil->GetProperty()->SetColor(VeilColour);
  this->Veil->GetProperty()->SetOpacity(VeilOpacity);
  this->Veil->GetProperty()->SetAmbient(AmbientShare);
  this->Veil->SetVisibility(!veiled.empty());
}

pqPalpateToolView::~pqPalpateToolView()
{
  for (vtkActor* actor : this->GetActors())
  {
    if (this->Renderer)
    {
      this->Renderer->RemoveActor(actor);
    }
  }
  if (this->Renderer)
  {
    this->Renderer->RemoveViewProp(this->Text);
    this->Renderer->RemoveViewProp(this->Numbers);
  }
}

bool pqPalpateToolView::Say(const std::string& text)
{
  const char* before = this->Text->GetInput();
  if (text == (before ? before : ""))
  {
    return false;
  }
  this->Text->SetInput(text.c_str());
  this->Text->SetVisibility(!text.empty());
  return true;
}

void pqPalpateToolView::Show(const palpate::Tick& tick, bool free, double depth)
{
  const palpate::Contact& contact = tick.contact;
  const bool touches = palpate::touches(contact.status);
  const palpate::Vec3 place = touches ? contact.tool_place() : tick.position;
  this->Tool->SetVisibility(touches || free);
  this->PlaceTool(place);
  // The tip of a blade is small, whatever the nodes are moved by.
  const bool cuts = contact.status == palpate::ContactStatus::cutting;
  this->Tool->SetScale(cuts ? this->BladeScale : 1);
  this->ShowForce(contact, place, depth);
}

void pqPalpateToolView::PlaceTool(const palpate::Vec3& place)
{
  palpate::Pose pose;
  pose.place = place;
  if (this->Poses)
  {
    pose = this->Poses->at(place);
  }
  vtkNew<vtkMatrix4x4> matrix;
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      matrix->SetElement(i, j, pose.rotation(i, j));
    }
    matrix->SetElement(i, 3, pose.place[i]);
  }
  this->Tool->SetUserMatrix(matrix);
}

void pqPalpateToolView::ShowTool(const palpate::Contact& contact, bool has)
{
  const palpate::Vec3& u = contact.displacement;
  const palpate::Vec3 place = contact.anchor + u;
  for (vtkActor* dot : { this->Nodes.Get(), this->Rims.Get() })
  {
    dot->SetPosition(u.x(), u.y(), u.z());
  }
  this->Tool->SetVisibility(has);
  this->PlaceTool(place);
  this->ShowForce(contact, place, u.norm());
}

void pqPalpateToolView::MarkMouse()
{
  this->Tool->GetProperty()->SetColor(MouseColour);
}

void pqPalpateToolView::PlaceNumbers(const palpate::Vec3& place)
{
  this->NumbersPlace->SetValue(place.x(), place.y(), place.z());
  if (!this->Renderer)
  {
    return;
  }
  const int* seen = this->NumbersPlace->GetComputedViewportValue(this->Renderer);
  const double at[] = { static_cast<double>(seen[0]), static_cast<double>(seen[1]) };
  const int* view = this->Renderer->GetSize();
  double size[2];
  this->Numbers->GetSize(this->Renderer, size);
  // The numbers are beside the tool, towards the middle of the view. Where that side is too narrow
  // they are moved until they are whole, and stand above the tool, or below it where the tool is in
  // the upper half.
  const bool isRight = 2 * at[0] > view[0];
  const double beside = isRight ? at[0] - NumbersAside - size[0] : at[0] + NumbersAside;
  const double left = std::max(0.0, std::min(beside, view[0] - size[0]));
  const double aside = NumbersAside + size[1] / 2;
  const double up = left == beside ? 0 : (2 * at[1] > view[1] ? -aside : aside);
  this->Numbers->SetPosition(left - at[0], up);
}

void pqPalpateToolView::ShowForce(
  const palpate::Contact& contact, const palpate::Vec3& place, double depth)
{
  const bool touches = palpate::touches(contact.status);
  const double force = contact.force.norm();
  const bool isKnown = touches && std::isfinite(force) && std::isfinite(depth);
  this->Numbers->SetVisibility(isKnown);
  this->Arrow->SetVisibility(isKnown && force > 0);
  if (isKnown)
  {
    const palpate::Vec3 sight = this->Renderer
      ? palpate::Vec3(this->Renderer->GetActiveCamera()->GetDirectionOfProjection())
      : palpate::Vec3::Zero();
    const double towards = force > 0 ? -sight.dot(contact.force) / force : 0;
    this->Numbers->SetInput(InNumbers(contact, force, depth, towards, this->Beyond).c_str());
    this->PlaceNumbers(place);
  }
  if (!this->Arrow->GetVisibility())
  {
    return;
  }
  // This matrix turns the arrow's own axis, x, to the force, and moves the arrow to the tool.
  const palpate::Vec3 along = contact.force / force;
  const palpate::Vec3 across = along.unitOrthogonal();
  const palpate::Vec3 third = along.cross(across);
  const double length = std::max(this->ArrowScale * force, this->ShortestArrow);
  vtkNew<vtkMatrix4x4> matrix;
  for (int i = 0; i < 3; ++i)
  {
    matrix->SetElement(i, 0, length * along[i]);
    matrix->SetElement(i, 1, length * across[i]);
    matrix->SetElement(i, 2, length * third[i]);
    matrix->SetElement(i, 3, place[i]);
  }
  this->Arrow->SetUserMatrix(matrix);
}
