#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/sdf_file.h"
#include "ferrers/math/rotation.h"

namespace ferrers {

/// A name as it stands in an element: what refers to a frame.
struct SdfReference {
  std::string name;  ///< Empty: none is given.
  SdfElement in;     ///< For messages.
};

/// Whatever has a pose and a name: the world, models, links, joints and explicit frames.
struct SdfFrame {
  enum class Kind { kWorld, kModel, kLink, kJoint, kFrame };
  Kind kind = Kind::kFrame;
  std::string name;
  int scope = 0;             ///< In which its name and its references are looked up.
  int inner = -1;            ///< kModel: the scope of what is in it.
  Pose X_RF;                 ///< In the frame that it is relative to; of a model's placement frame where it has one.
  SdfReference relative_to;  ///< Empty: `attached_to` where that is given, else the scope's own frame.
  SdfReference attached_to;  ///< kFrame: as written; kModel: its canonical link; kJoint: its child.
  SdfReference placement;    ///< kModel: the frame inside it that `X_RF` places.
  SdfElement element;
};

/// All frames of a model or world, and where they are: the graph by which each is relative to another, and that by
/// which each moves along with a link or the world. Frame 0 is the world, scope 0 is what is in it.
///
/// Frames are added first, then asked for. Errors are told once: F302 for a name twice, F604 for a reference to
/// nothing, F605 for one that leads back to itself. Cost: O(frames · log).
class SdfFrames {
 public:
  static constexpr int kWorldFrame = 0;

  SdfFrames();

  const SdfFrame& operator[](int frame) const { return frames_[static_cast<std::size_t>(frame)]; }
  int size() const { return static_cast<int>(frames_.size()); }

  /// The new frame's index. `named`: false for one that nothing can refer to by name.
  int add(SdfFrame frame, bool named = true);
  bool is_taken(int scope, std::string_view name) const;
  /// The scope inside of a model. `shares`: names are those of that scope, as where a model is merged into another;
  /// else -1.
  int add_scope(int own_frame, int shares = -1);
  bool share_names(int scope, int other) const;
  void attach(int frame, SdfReference to);
  int own_frame(int scope) const { return scopes_[static_cast<std::size_t>(scope)].own_frame; }

  /// "arm::hand" from this scope; also "world" and "__model__".
  std::optional<int> find(int scope, std::string_view name) const;
  /// The same, told with F604 where it is not found.
  std::optional<int> find_or_tell(int scope, const SdfReference& reference, std::string_view what) const;

  Pose pose_in_world(int frame);  ///< X_WF as drawn; the identity after an error.
  int body_of(int frame);         ///< The link that the frame moves with, or the world.

 private:
  struct Scope {
    int own_frame = 0;
    int table = 0;  ///< Scope whose names it uses.
    std::map<std::string, int, std::less<>> names;
  };
  struct Progress {
    bool under_way = false, stepping = false;
    std::optional<Pose> pose;
    std::optional<int> body;
    std::optional<Pose> step;
    std::optional<int> base;
  };

  int base_of(int frame);
  int find_base(int frame) const;
  Pose step_of(int frame);
  int next_towards_body(int frame);
  void tell_circle(int frame, std::string_view what, const SdfReference& at) const;

  std::vector<SdfFrame> frames_;
  std::vector<Scope> scopes_;
  std::vector<Progress> progress_;
};

}  // namespace ferrers
