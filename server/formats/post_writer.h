// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "server/formats/machine_kinematics.h"
#include "server/formats/post.h"
#include "server/formats/program_writing.h"

namespace kerf {

/// The order of a program for any control: the tool leaves the workpiece before every tool change,
/// jump and turn of the tables; a new tool is loaded, spindle and coolant follow, and the tool
/// approaches without cutting. Derived classes write the words.
class PostWriter : public ProgramWriter {
 public:
  void note(const std::string& line) final { notes_.push_back(line); }
  WriteResult add(const ProgramMotion& motion) final;
  /// Arcs are written for upright tools only. Arcs with tables and tool vectors depend on settings.
  bool takes(const FittedArc&) const override { return kind_ == MachineKinematics::kXyz; }
  WriteResult add_arc(const ProgramMotion& motion, const FittedArc& arc) final;
  WriteResult add_hole(const ProgramMotion& first, const DrilledHole& hole) final;
  WriteResult remark(const MachineRemark& said) final;
  WriteResult finish() final;

 protected:
  /// `scene` and `out` must outlive the writer.
  PostWriter(const PostRules& rules, const Scene& scene, std::ostream& out);

  /// The head of the program with the notes.
  virtual void begin() = 0;
  /// Tool-center-point control ends, and the tool leaves the workpiece.
  virtual void retract() = 0;
  /// Loads tool() while the tool is away.
  virtual void change_tool(bool first) = 0;
  /// Moves the tool, which is away, to a pose; angles() are those of the pose.
  virtual void approach(const ToolPose& pose) = 0;
  /// Moves from last() to a pose; end_angles() are those of the pose.
  virtual void straight(const ToolPose& to, bool rapid, double duration_s) = 0;
  /// Moves on an arc from last() to a pose. Precondition: takes(arc).
  virtual void arc(const ToolPose& to, const FittedArc& arc, double duration_s) = 0;
  /// Drills a hole, after traversing to it from last(). Precondition: drills(hole).
  virtual void drill(const DrilledHole&) {}
  /// Ends a series of holes, before anything else follows.
  virtual void end_drilling() {}
  virtual void dwell(double seconds) = 0;
  virtual void say(const MachineRemark& said) = 0;
  virtual void end() = 0;

  const PostRules& rules() const { return rules_; }
  const Scene& scene() const { return scene_; }
  std::ostream& out() { return out_; }
  const std::vector<std::string>& notes() const { return notes_; }
  MachineKinematics kind() const { return kind_; }
  /// Whether the machine has rotary tables; whether programs give the tool axis as a vector.
  bool rotary() const { return rotary_; }
  bool vector() const { return vector_; }
  ToolId tool() const { return tool_; }
  const ToolPose& last() const { return last_; }
  const RotaryAngles& angles() const { return angles_; }
  const RotaryAngles& end_angles() const { return end_angles_; }
  /// The speed in the next remark about the spindle, or 0 without one.
  double next_rpm() const;
  /// The feed of a motion from last(), mm per minute, or degrees per minute if the tip rests.
  double feed(const ToolPose& to, double duration_s) const;

 private:
  ToolPose rounded(const ToolPose& pose) const;
  WriteResult write(const ProgramMotion& motion, const FittedArc* arc);
  DrilledHole rounded(const DrilledHole& hole) const;
  void place(const ToolPose& pose, ToolId tool);
  void leave_hole();
  void say_held(std::size_t count);
  void turn(const ToolPose& from, const ToolPose& to, const ProgramMotion& motion, int halvings);

  const PostRules& rules_;
  const Scene& scene_;
  std::ostream& out_;
  const MachineKinematics kind_;
  const bool rotary_, vector_;
  bool begun_ = false, placed_ = false, drills_ = false;
  ToolId tool_ = 0;
  ToolPose last_;
  RotaryAngles angles_, end_angles_;
  double late_s_ = 0;  ///< time of motions too short to be written
  std::vector<MachineRemark> held_;
  std::vector<std::string> notes_;
};

}  // namespace kerf
