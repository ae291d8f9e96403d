#include "perch/candidates/candidate_batches.hpp"

#include <algorithm>

#include "perch/candidates/packed_candidate.hpp"
#include "perch/observation/packed_runs.hpp"

namespace perch {
namespace {

std::optional<FixedCandidates::Hypothesis> refine_alone(const LocalizationProblem& problem, std::size_t model,
                                                        std::size_t grid_pose, CandidateMaker& maker) {
  const auto [pose, misfit] =
      maker.refined(model, problem.grid(model).pose(static_cast<std::int64_t>(grid_pose)));
  const Window window = problem.window(model, pose);
  if (window.empty() || !problem.admits(model, pose)) return std::nullopt;
  return FixedCandidates::Hypothesis{
      model, pose, static_cast<float>(misfit), window,
      problem.explained_bound().blocks(problem.models()[model], problem.camera_from_model(model, pose))};
}

/// A service whose questions need nothing but the problem.
class ProblemOnly : public Service {
 public:
  explicit ProblemOnly(std::shared_ptr<ServedProblem> served) : served_(std::move(served)) {}
  void hear(ByteReader&, const Executor&, const StopCondition&) override {}
  void report(ByteWriter& to) override { served_->write_effort(to); }

 protected:
  ServedProblem& served() { return *served_; }

 private:
  std::shared_ptr<ServedProblem> served_;
};

class RefineService final : public ProblemOnly {
 public:
  using ProblemOnly::ProblemOnly;
  void answer(ByteReader& question, std::size_t worker, const StopCondition&, ByteWriter& answer) override {
    const std::size_t model = question.count(), grid_pose = question.count();
    const auto refined = refine_alone(served().problem(), model, grid_pose, served().maker(worker));
    if (!refined) return;
    answer.value(refined->pose);
    answer.value(refined->misfit);
    write_window(answer, refined->window);
    write_runs(answer, refined->near);
  }
};

class ValueService final : public ProblemOnly {
 public:
  using ProblemOnly::ProblemOnly;
  void answer(ByteReader& question, std::size_t worker, const StopCondition&, ByteWriter& answer) override {
    const std::size_t model = question.count();
    const Pose pose = question.value<Pose>();
    static_cast<void>(served().problem());
    if (const auto candidate = served().maker(worker).value(model, pose)) write_candidate(answer, *candidate);
  }
};

}  // namespace

RefineBatch::RefineBatch(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers)
    : problem_(problem), makers_(makers) {
  std::size_t size = 0;
  for (std::size_t model = 0; model < problem.models().size(); ++model) {
    first_.push_back(size);
    if (problem.copies()[problem.kind_of(model)] > 0)
      size += static_cast<std::size_t>(problem.grid(model).size());
  }
  refined.resize(size);
}

std::size_t RefineBatch::model_of(std::size_t item) const {
  return static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), item) - first_.begin()) - 1;
}

void RefineBatch::work(std::size_t item, std::size_t worker) {
  const std::size_t model = model_of(item);
  refined[item] = refine_alone(problem_, model, item - first_[model], makers_[worker]);
}

void RefineBatch::write_question(std::size_t item, ByteWriter& question) const {
  const std::size_t model = model_of(item);
  question.count(model);
  question.count(item - first_[model]);
}

void RefineBatch::read_answer(std::size_t item, ByteReader& answer) {
  if (answer.done()) return;
  Hypothesis hypothesis;
  hypothesis.model = model_of(item);
  answer.read(hypothesis.pose);
  answer.read(hypothesis.misfit);
  hypothesis.window = read_window(answer);
  hypothesis.near = read_runs(answer);
  refined[item] = std::move(hypothesis);
}

void ValueBatch::work(std::size_t item, std::size_t worker) {
  const Hypothesis& hypothesis = open_[which_[item]];
  made[item] = makers_[worker].value(hypothesis.model, hypothesis.pose);
}

void ValueBatch::write_question(std::size_t item, ByteWriter& question) const {
  const Hypothesis& hypothesis = open_[which_[item]];
  question.count(hypothesis.model);
  question.value(hypothesis.pose);
}

void ValueBatch::read_answer(std::size_t item, ByteReader& answer) {
  if (answer.done()) return;
  made[item] = read_candidate(answer);
  made[item]->drawn_elsewhere = !made[item]->explained_pixels.empty();
}

std::shared_ptr<Service> make_refine_service(std::shared_ptr<ServedProblem> served) {
  return std::make_shared<RefineService>(std::move(served));
}

std::shared_ptr<Service> make_value_service(std::shared_ptr<ServedProblem> served) {
  return std::make_shared<ValueService>(std::move(served));
}

}  // namespace perch
