#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "perch/candidates/served_problem.hpp"
#include "perch/parallel/batch.hpp"
#include "perch/tree/child_valuation.hpp"

namespace perch {

/// The children of a state of the tree in context, made and valued.
class ChildrenBatch final : public Batch {
 public:
  static constexpr const char* name = "children";

  struct Hypothesis {
    std::size_t model = 0;
    std::int64_t grid_pose = -1;  ///< -1: the object is left out
    /// It has been made before as it is alone; see ChildValuation::make.
    bool known = false;
    /// What it is alone is at hand: where it is no more here, it need not come again.
    bool at_hand = false;
  };
  struct Child {
    bool valid = false;
    std::int64_t cost = 0;
    bool as_alone = false;
    std::optional<Candidate> made;  ///< without its rendering; empty where left out, or at hand and as alone
  };

  /// Keeps references.
  ChildrenBatch(const LocalizationProblem& problem, const MonotoneSettings& settings,
                const ParentScene& parent, std::vector<Hypothesis> hypotheses, ChildValuation& valuation,
                std::vector<CandidateMaker>& makers)
      : children(hypotheses.size()),
        problem_(problem),
        settings_(settings),
        parent_(parent),
        hypotheses_(std::move(hypotheses)),
        valuation_(valuation),
        makers_(makers) {}

  std::size_t size() const override { return children.size(); }
  std::string topic() const override { return name; }
  void work(std::size_t item, std::size_t worker) override;
  void write_common(ByteWriter& common) const override;
  void write_question(std::size_t item, ByteWriter& question) const override;
  void read_answer(std::size_t item, ByteReader& answer) override;
  void read_report(ByteReader& report) override { effort_elsewhere += read_effort(report); }
  /// By where on the grid it is: what a process keeps of it as it is alone serves all states.
  double home(std::size_t item) const override;

  std::vector<Child> children;
  Effort effort_elsewhere;

 private:
  const LocalizationProblem& problem_;
  const MonotoneSettings& settings_;
  const ParentScene& parent_;
  std::vector<Hypothesis> hypotheses_;
  ChildValuation& valuation_;
  std::vector<CandidateMaker>& makers_;
};

std::shared_ptr<Service> make_children_service(std::shared_ptr<ServedProblem> served);

}  // namespace perch
