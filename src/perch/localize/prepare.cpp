#include "perch/localize/prepare.hpp"

namespace perch {

Scene prepare(Scene scene, const Settings&, const Executor&) {
  return scene;
}

}  // namespace perch
