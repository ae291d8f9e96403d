#include "perch/localize/services.hpp"

#include "perch/candidates/candidate_batches.hpp"
#include "perch/localize/packed_scene.hpp"
#include "perch/localize/setup.hpp"
#include "perch/tree/children_batch.hpp"
#include "perch/tree/nodes_batch.hpp"

namespace perch {
namespace {

constexpr const char* problem_topic = "problem";

class ProblemService final : public Service {
 public:
  explicit ProblemService(std::shared_ptr<ServedProblem> served) : served_(std::move(served)) {}

  void hear(ByteReader& common, const Executor& executor, const StopCondition& stop) override {
    served_->clear();
    const Scene scene = read_scene(common);
    const Settings settings = read_settings(common);
    auto problem = make_problem(scene, settings, executor, stop);
    std::vector<CandidateMaker> makers = make_makers(*problem, executor);
    served_->set(std::move(problem), std::move(makers));
  }
  void answer(ByteReader&, std::size_t, const StopCondition&, ByteWriter&) override {}

 private:
  std::shared_ptr<ServedProblem> served_;
};

}  // namespace

Services localization_services() {
  const auto served = std::make_shared<ServedProblem>();
  return {{problem_topic, std::make_shared<ProblemService>(served)},
          {RefineBatch::name, make_refine_service(served)},
          {ValueBatch::name, make_value_service(served)},
          {ChildrenBatch::name, make_children_service(served)},
          {NodesBatch::name, make_nodes_service(served)}};
}

void tell_problem(const Scene& scene, const Settings& settings, const Executor& executor) {
  if (executor.processes() == 1) return;
  ByteWriter to;
  write_scene(to, scene);
  write_settings(to, settings);
  executor.tell(problem_topic, to.take());
}

}  // namespace perch
