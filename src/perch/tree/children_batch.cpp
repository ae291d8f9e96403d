#include "perch/tree/children_batch.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <tuple>

#include "perch/candidates/packed_candidate.hpp"

namespace perch {
namespace {

using Child = ChildrenBatch::Child;
using Hypothesis = ChildrenBatch::Hypothesis;

/// What an answer holds, as bits.
enum : std::uint8_t { is_valid = 1, is_as_alone = 2, has_candidate = 4 };

Child make_child(const Hypothesis& hypothesis, const ParentScene& parent, ChildValuation& valuation,
                 CandidateMaker& maker) {
  Child child;
  const auto take = [&](const ChildValuation::Value& value) {
    child.valid = value.valid;
    child.cost = value.cost;
  };
  if (hypothesis.grid_pose < 0) {
    take(valuation.value(parent, absent_candidate(hypothesis.model), maker));
    return child;
  }
  ChildValuation::InContext made =
      valuation.make(hypothesis.model, hypothesis.grid_pose, hypothesis.known, parent.composite.depth, maker);
  child.as_alone = made.as_alone;
  if (!made.candidate) return child;
  take(valuation.value(parent, *made.candidate, maker));
  if (!child.valid || (hypothesis.at_hand && child.as_alone)) return child;
  made.candidate->patch = {};  // too many are made in context to keep their renderings
  child.made = std::move(made.candidate);
  return child;
}

class ChildrenService final : public Service {
 public:
  explicit ChildrenService(std::shared_ptr<ServedProblem> served) : served_(std::move(served)) {}

  void hear(ByteReader& common, const Executor&, const StopCondition&) override {
    const LocalizationProblem& problem = served_->problem();
    const auto settings = common.value<MonotoneSettings>();
    if (version_ != served_->version()) {
      version_ = served_->version();
      placed_.clear();
      valuation_.emplace(problem, settings, true);
    }
    std::vector<const Candidate*> placed;
    for (std::uint64_t n = common.count(); n > 0; --n) placed.push_back(&read_placed(common));
    parent_ = valuation_->parent(std::move(placed), served_->maker(0));
    // The first process does all this too.
    served_->forget_effort();
  }

  void answer(ByteReader& question, std::size_t worker, const StopCondition&, ByteWriter& answer) override {
    Hypothesis hypothesis;
    hypothesis.model = question.count();
    hypothesis.grid_pose = static_cast<std::int64_t>(question.count()) - 1;
    question.read(hypothesis.known);
    question.read(hypothesis.at_hand);
    const Child child = make_child(hypothesis, parent_, *valuation_, served_->maker(worker));
    answer.value(static_cast<std::uint8_t>((child.valid ? is_valid : 0) | (child.as_alone ? is_as_alone : 0) |
                                           (child.made ? has_candidate : 0)));
    if (child.valid) answer.count(static_cast<std::uint64_t>(child.cost));
    if (child.made) write_candidate(answer, *child.made);
  }

  void report(ByteWriter& to) override { served_->write_effort(to); }

 private:
  /// Candidates placed are valued again where they are not known from an earlier state.
  const Candidate& read_placed(ByteReader& common) {
    const std::size_t model = common.count();
    const bool absent = common.value<bool>();
    const Pose pose = common.value<Pose>();
    const auto [place, is_new] =
        placed_.try_emplace({model, absent, pose.x, pose.y, pose.yaw}, absent_candidate(model));
    if (is_new && !absent) {
      CandidateMaker& maker = served_->maker(0);
      auto made = maker.value(model, pose);
      if (!made) throw std::logic_error("nothing of a placed object is in view");
      maker.add_volumes(*made);
      made->patch = {};
      place->second = std::move(*made);
    }
    return place->second;
  }

  std::shared_ptr<ServedProblem> served_;
  std::uint64_t version_ = 0;
  std::optional<ChildValuation> valuation_;
  ParentScene parent_;
  std::map<std::tuple<std::size_t, bool, double, double, double>, Candidate> placed_;
};

}  // namespace

void ChildrenBatch::work(std::size_t item, std::size_t worker) {
  children[item] = make_child(hypotheses_[item], parent_, valuation_, makers_[worker]);
}

void ChildrenBatch::write_common(ByteWriter& common) const {
  common.value(settings_);
  common.count(parent_.placed.size());
  for (const Candidate* candidate : parent_.placed) {
    common.count(candidate->model);
    common.value(candidate->absent);
    common.value(candidate->pose);
  }
}

void ChildrenBatch::write_question(std::size_t item, ByteWriter& question) const {
  const Hypothesis& hypothesis = hypotheses_[item];
  question.count(hypothesis.model);
  question.count(static_cast<std::uint64_t>(hypothesis.grid_pose + 1));
  question.value(hypothesis.known);
  question.value(hypothesis.at_hand);
}

void ChildrenBatch::read_answer(std::size_t item, ByteReader& answer) {
  Child& child = children[item];
  const auto holds = answer.value<std::uint8_t>();
  child.valid = (holds & is_valid) != 0;
  child.as_alone = (holds & is_as_alone) != 0;
  if (child.valid) child.cost = static_cast<std::int64_t>(answer.count());
  if ((holds & has_candidate) != 0) child.made = read_candidate(answer);
}

double ChildrenBatch::home(std::size_t item) const {
  const Hypothesis& hypothesis = hypotheses_[item];
  if (hypothesis.grid_pose < 0) return 0.0;
  return static_cast<double>(hypothesis.grid_pose) /
         static_cast<double>(problem_.grid(hypothesis.model).size());
}

std::shared_ptr<Service> make_children_service(std::shared_ptr<ServedProblem> served) {
  return std::make_shared<ChildrenService>(std::move(served));
}

}  // namespace perch
