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

 private:
  std::string file_;
  std::shared_ptr<const mjModel> model_;
};

}  // namespace slalom::mujoco
