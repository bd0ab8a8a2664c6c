#include "ferrers/formats/sdf_frames.h"

#include <fmt/format.h>

#include <utility>

namespace ferrers {

SdfFrames::SdfFrames() {
  SdfFrame world;
  world.kind = SdfFrame::Kind::kWorld;
  world.name = "world";
  world.inner = 0;
  frames_.push_back(world);
  progress_.emplace_back();
  progress_[0].pose = Pose();
  progress_[0].body = kWorldFrame;
  scopes_.emplace_back();
}

bool SdfFrames::is_taken(int scope, std::string_view name) const {
  const Scope& table = scopes_[static_cast<std::size_t>(scopes_[static_cast<std::size_t>(scope)].table)];
  return table.names.find(name) != table.names.end();
}

int SdfFrames::add(SdfFrame frame, bool named) {
  const int index = size();
  if (named) {
    Scope& table = scopes_[static_cast<std::size_t>(scopes_[static_cast<std::size_t>(frame.scope)].table)];
    if (!table.names.emplace(frame.name, index).second) {
      frame.element.attribute_error("name", "F302",
                                    fmt::format("the name '{}' stands twice in its model or world", frame.name),
                                    "models, links, joints and frames of one model share their names");
    }
  }
  frames_.push_back(std::move(frame));
  progress_.emplace_back();
  return index;
}

int SdfFrames::add_scope(int own_frame, int shares) {
  const int index = static_cast<int>(scopes_.size());
  Scope scope;
  scope.own_frame = own_frame;
  scope.table = shares < 0 ? index : scopes_[static_cast<std::size_t>(shares)].table;
  scopes_.push_back(std::move(scope));
  return index;
}

bool SdfFrames::share_names(int scope, int other) const {
  return scopes_[static_cast<std::size_t>(scope)].table == scopes_[static_cast<std::size_t>(other)].table;
}

void SdfFrames::attach(int frame, SdfReference to) {
  frames_[static_cast<std::size_t>(frame)].attached_to = std::move(to);
}

std::optional<int> SdfFrames::find(int scope, std::string_view name) const {
  if (name == "world") return kWorldFrame;
  while (true) {
    const Scope& own = scopes_[static_cast<std::size_t>(scope)];
    if (name == "__model__" && own.own_frame != kWorldFrame) return own.own_frame;
    const auto& names = scopes_[static_cast<std::size_t>(own.table)].names;
    if (const auto found = names.find(name); found != names.end()) return found->second;
    // The longest model name is tried last: older files write '::' into names.
    int inner = -1;
    for (std::size_t cut = name.find("::"); cut != std::string_view::npos && inner < 0;
         cut = name.find("::", cut + 2)) {
      const auto model = names.find(name.substr(0, cut));
      if (model == names.end() || frames_[static_cast<std::size_t>(model->second)].kind != SdfFrame::Kind::kModel)
        continue;
      inner = frames_[static_cast<std::size_t>(model->second)].inner;
      name.remove_prefix(cut + 2);
      break;
    }
    if (inner < 0) return std::nullopt;
    scope = inner;
  }
}

std::optional<int> SdfFrames::find_or_tell(int scope, const SdfReference& reference, std::string_view what) const {
  const std::optional<int> found = find(scope, reference.name);
  if (!found) {
    reference.in.error("F604", fmt::format("there is no '{}', which {} names", reference.name, what),
                       "names are those of the same model; 'inner::link' is the link of a model inside it");
  }
  return found;
}

void SdfFrames::tell_circle(int frame, std::string_view what, const SdfReference& at) const {
  const SdfElement& element = at.in ? at.in : (*this)[frame].element;
  element.error("F605", fmt::format("{} of '{}' leads back to itself", what, (*this)[frame].name));
}

/// The frame that this one's pose is given in.
int SdfFrames::base_of(int index) {
  std::optional<int>& base = progress_[static_cast<std::size_t>(index)].base;
  if (!base) base = find_base(index);
  return *base;
}

int SdfFrames::find_base(int index) const {
  const SdfFrame& frame = (*this)[index];
  std::optional<int> found;
  const bool by_attachment = frame.kind == SdfFrame::Kind::kFrame || frame.kind == SdfFrame::Kind::kJoint;
  if (!frame.relative_to.name.empty()) {
    found = find_or_tell(frame.scope, frame.relative_to, "'relative_to'");
  } else if (by_attachment && !frame.attached_to.name.empty()) {
    found = find(frame.scope, frame.attached_to.name);  // told where the attachment is asked for
  } else {
    return own_frame(frame.scope);
  }
  return found.value_or(kWorldFrame);
}

/// The pose of a frame in the one that it is given in. Of a model placed by a frame inside it, X_RM = X_RP · X_MP⁻¹.
Pose SdfFrames::step_of(int index) {
  if (progress_[static_cast<std::size_t>(index)].step) return *progress_[static_cast<std::size_t>(index)].step;
  const SdfFrame frame = (*this)[index];
  Pose step = frame.X_RF;
  if (progress_[static_cast<std::size_t>(index)].stepping) {
    tell_circle(index, "the placement frame", frame.placement);
    return step;
  }
  progress_[static_cast<std::size_t>(index)].stepping = true;
  if (!frame.placement.name.empty()) {
    Pose X_MP;
    const std::optional<int> placed = find_or_tell(frame.inner, frame.placement, "the placement frame");
    int at = placed.value_or(index);
    int left = size();
    while (at != index && at != kWorldFrame && left-- > 0) {
      X_MP = step_of(at) * X_MP;
      at = base_of(at);
    }
    if (at != index) {
      tell_circle(index, "the placement frame", frame.placement);
    } else {
      step = step * X_MP.inverse();
    }
  }
  progress_[static_cast<std::size_t>(index)].step = step;
  return step;
}

Pose SdfFrames::pose_in_world(int frame) {
  std::vector<int> way;
  int at = frame;
  while (!progress_[static_cast<std::size_t>(at)].pose) {
    if (progress_[static_cast<std::size_t>(at)].under_way) {
      tell_circle(at, "the pose", (*this)[at].relative_to);
      progress_[static_cast<std::size_t>(at)].pose = Pose();
      break;
    }
    progress_[static_cast<std::size_t>(at)].under_way = true;
    way.push_back(at);
    at = base_of(at);
  }
  for (auto one = way.rbegin(); one != way.rend(); ++one) {
    Progress& progress = progress_[static_cast<std::size_t>(*one)];
    progress.under_way = false;
    if (!progress.pose) progress.pose = *progress_[static_cast<std::size_t>(at)].pose * step_of(*one);
    at = *one;
  }
  return *progress_[static_cast<std::size_t>(frame)].pose;
}

/// The frame that this one, no link and not the world, moves along with.
int SdfFrames::next_towards_body(int index) {
  const SdfFrame& frame = (*this)[index];
  const int scope = frame.kind == SdfFrame::Kind::kModel ? frame.inner : frame.scope;
  if (frame.attached_to.name.empty()) {
    return frame.kind == SdfFrame::Kind::kFrame ? own_frame(frame.scope) : kWorldFrame;
  }
  constexpr std::string_view kinds[] = {"", "'canonical_link'", "", "<child>", "'attached_to'"};
  const std::optional<int> found = find_or_tell(scope, frame.attached_to, kinds[static_cast<std::size_t>(frame.kind)]);
  return found.value_or(kWorldFrame);
}

int SdfFrames::body_of(int frame) {
  std::vector<int> way;
  int at = frame;
  while ((*this)[at].kind != SdfFrame::Kind::kLink && !progress_[static_cast<std::size_t>(at)].body) {
    if (progress_[static_cast<std::size_t>(at)].under_way) {
      tell_circle(at, "what carries the frame", (*this)[at].attached_to);
      at = kWorldFrame;
      break;
    }
    progress_[static_cast<std::size_t>(at)].under_way = true;
    way.push_back(at);
    at = next_towards_body(at);
  }
  const int body = progress_[static_cast<std::size_t>(at)].body.value_or(at);
  for (const int one : way) {
    progress_[static_cast<std::size_t>(one)].under_way = false;
    progress_[static_cast<std::size_t>(one)].body = body;
  }
  return body;
}

}  // namespace ferrers
