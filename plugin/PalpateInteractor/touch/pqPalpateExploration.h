// SPDX-License-Identifier: BSD-3-Clause
/// Explores the space that is touched around the hand, where its Precompute State Space asks for
/// that. The explorers are programs on this machine or elsewhere. The thread that has them gives
/// what they find to the servo loop, and filters that show the body take it from there too.
#pragma once

#include <QPointer>
#include <QString>
#include <memory>
#include <vector>

#include "pqPipelineSource.h"
#include "vtkPalpateStateSpace.h"

namespace palpate
{
struct ExpectedPress;
class HandExploration;
class Servo;
class Touchable;
struct TouchableOptions;
}
class pqOutputPort;
struct vtkPalpateFollowing;

class pqPalpateExploration
{
public:
  /// Which explorers there are.
  struct Explorers
  {
    /// On this machine; 0: one less than there are cores, but at least one.
    int Number = 0;
    /// Where others come to, or are, see palpate::ExplorerHub; empty: there are none.
    QString Endpoint;
    /// The folder of the keys; empty: new ones.
    QString Keys;
  };

  /// @return null: the space is not to be explored around the hand.
  /// @throws std::runtime_error it is, but cannot be in this program, or on this server.
  static std::unique_ptr<pqPalpateExploration> Of(pqOutputPort* space);
  ~pqPalpateExploration();
  pqPalpateExploration(const pqPalpateExploration&) = delete;
  void operator=(const pqPalpateExploration&) = delete;

  /// The points of the surface that the tool may press: 1, else 0.
  std::vector<char> Pressable(const palpate::Surface& surface) const;
  /// A deep press, as nothing may have been found yet that would tell.
  palpate::ExpectedPress Expected(const palpate::TouchToolSpace& rigid) const;

  /// Whether the servo loop gets what is found at once, or goes on with the body that it has until
  /// enough is found where the hand is.
  enum class Giving
  {
    AtOnce,
    WhereTheHandIs
  };
  /// @param servo It must outlive the exploration.
  /// @throws palpate::InputError, palpate::BackendError it cannot begin.
  void Begin(const Explorers& explorers, const palpate::TouchableOptions& options,
    palpate::Servo* servo, Giving giving);
  /// The body, if it has grown since the last call; else null.
  std::shared_ptr<const palpate::Touchable> TakeGrown();
  /// What is found, in words, and what is wrong; empty: nothing is.
  QString InWords(QString& problem) const;
  /// Ends it. The file has what was found.
  /// @return What could not be kept; empty: all is kept.
  QString End();
  /// Has the pipeline take what was found from the file.
  void HandOver();

private:
  explicit pqPalpateExploration(
    pqPipelineSource* source, std::shared_ptr<const vtkPalpateFollowing> following);

  struct Grown;

  QPointer<pqPipelineSource> Source;
  std::shared_ptr<const vtkPalpateFollowing> Following;
  std::shared_ptr<Grown> Newest;
  std::shared_ptr<palpate::HandExploration> Running;
};
