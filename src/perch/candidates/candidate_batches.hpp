#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "perch/candidates/fixed_candidates.hpp"
#include "perch/candidates/served_problem.hpp"
#include "perch/parallel/batch.hpp"

namespace perch {

/// Grid poses refined alone, of all models that are present.
class RefineBatch final : public Batch {
 public:
  static constexpr const char* name = "refine";
  using Hypothesis = FixedCandidates::Hypothesis;

  /// Keeps references.
  RefineBatch(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers);

  std::size_t size() const override { return refined.size(); }
  std::string topic() const override { return name; }
  std::size_t grain() const override { return 16; }
  void work(std::size_t item, std::size_t worker) override;
  void write_question(std::size_t item, ByteWriter& question) const override;
  void read_answer(std::size_t item, ByteReader& answer) override;
  void read_report(ByteReader& report) override { effort_elsewhere += read_effort(report); }

  /// In the order of models and grid poses; empty where the pose is out of view or not admitted.
  std::vector<std::optional<Hypothesis>> refined;
  Effort effort_elsewhere;

 private:
  std::size_t model_of(std::size_t item) const;

  const LocalizationProblem& problem_;
  std::vector<CandidateMaker>& makers_;
  std::vector<std::size_t> first_;  ///< item of each model
};

/// Hypotheses valued alone.
class ValueBatch final : public Batch {
 public:
  static constexpr const char* name = "value";
  using Hypothesis = FixedCandidates::Hypothesis;

  /// \param which places in `open`. Keeps references.
  ValueBatch(const std::vector<Hypothesis>& open, const std::vector<std::size_t>& which,
             std::vector<CandidateMaker>& makers)
      : made(which.size()), open_(open), which_(which), makers_(makers) {}

  std::size_t size() const override { return made.size(); }
  std::string topic() const override { return name; }
  void work(std::size_t item, std::size_t worker) override;
  void write_question(std::size_t item, ByteWriter& question) const override;
  void read_answer(std::size_t item, ByteReader& answer) override;
  void read_report(ByteReader& report) override { effort_elsewhere += read_effort(report); }

  std::vector<std::optional<Candidate>> made;  ///< empty where nothing is in view
  Effort effort_elsewhere;

 private:
  const std::vector<Hypothesis>& open_;
  const std::vector<std::size_t>& which_;
  std::vector<CandidateMaker>& makers_;
};

std::shared_ptr<Service> make_refine_service(std::shared_ptr<ServedProblem> served);
std::shared_ptr<Service> make_value_service(std::shared_ptr<ServedProblem> served);

}  // namespace perch
