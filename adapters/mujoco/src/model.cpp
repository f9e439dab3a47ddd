#include "slalom/mujoco/model.hpp"

#include <stdexcept>

#include "slalom/core/error.hpp"

namespace slalom::mujoco {

Model::Model(const std::filesystem::path& file) : file_(file.string()) {
  char message[1024] = "";
  mjModel* const model = mj_loadXML(file_.c_str(), nullptr, message, sizeof message);
  if (!model) throw IoError(file_, 0, message);
  model_ = std::shared_ptr<const mjModel>(model,
                                          [](const mjModel* m) { mj_deleteModel(const_cast<mjModel*>(m)); });
}

int Model::id(mjtObj type, const std::string& name) const {
  const int found = mj_name2id(model_.get(), type, name.c_str());
  if (found < 0)
    throw std::invalid_argument(file_ + ": has no " + mju_type2Str(type) + " with the name '" + name + "'");
  return found;
}

}  // namespace slalom::mujoco
