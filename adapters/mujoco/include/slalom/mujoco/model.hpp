#pragma once

#include <mujoco/mujoco.h>

#include <filesystem>
#include <memory>
#include <string>

namespace slalom::mujoco {

/// A compiled MuJoCo model. It does not change, and its copies share it.
class Model {
 public:
  /// Compiles a model in MJCF or URDF. Throws IoError, which names the file and gives MuJoCo's message.
  explicit Model(const std::filesystem::path& file);

  /// The model, for functions of MuJoCo.
  const mjModel& get() const noexcept { return *model_; }
  /// A field of the model.
  const mjModel* operator->() const noexcept { return model_.get(); }
  /// The file that it was loaded from.
  const std::string& file() const noexcept { return file_; }

  /// The index of a named element, for instance id(mjOBJ_BODY, "torso"). Throws std::invalid_argument, which
  /// names the file and the element, if there is none.
  int id(mjtObj type, const std::string& name) const;
  /// The index at which the positions of a joint start.
  int position_of(const std::string& joint) const { return model_->jnt_qposadr[id(mjOBJ_JOINT, joint)]; }
  /// The index at which the velocities of a joint start.
  int velocity_of(const std::string& joint) const { return model_->jnt_dofadr[id(mjOBJ_JOINT, joint)]; }

 private:
  std::string file_;
  std::shared_ptr<const mjModel> model_;
};

}  // namespace slalom::mujoco
