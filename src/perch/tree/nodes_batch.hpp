#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "perch/candidates/served_problem.hpp"
#include "perch/parallel/batch.hpp"
#include "perch/tree/node_work.hpp"

namespace perch {

/// The candidates that nodes may hold, numbered without gaps, in their order: what goes to other processes.
struct NodeCandidates {
  std::vector<CandidateId> ids;
  std::vector<std::uint32_t> numbers;  ///< of each candidate of the set, where it has one

  NodeCandidates() = default;
  /// \param kept of each candidate of the set: not 0 where it may be held.
  explicit NodeCandidates(const std::vector<char>& kept);
};

/// Nodes of the branching over scenes. Before, the services of the topic must be told write_candidates().
/// A question names what is placed and the choices that are left, so that processes keep nothing of nodes.
class NodesBatch final : public Batch {
 public:
  static constexpr const char* name = "nodes";

  /// Keeps references. \param nodes and \param findings one for each.
  NodesBatch(const NodeWork& work, const NodeCandidates& candidates, std::span<const OpenNode> nodes,
             std::int64_t upper_bound, std::vector<CandidateMaker>& makers, const StopCondition& stop,
             std::span<NodeFinding> findings)
      : work_(work),
        candidates_(candidates),
        nodes_(nodes),
        upper_bound_(upper_bound),
        makers_(makers),
        stop_(stop),
        findings_(findings) {}

  std::size_t size() const override { return nodes_.size(); }
  std::string topic() const override { return name; }
  void work(std::size_t item, std::size_t worker) override {
    findings_[item] = work_.work(nodes_[item], upper_bound_, makers_[worker], stop_);
  }
  void write_common(ByteWriter& common) const override;
  void write_question(std::size_t item, ByteWriter& question) const override;
  void read_answer(std::size_t item, ByteReader& answer) override;
  void read_report(ByteReader& report) override { effort_elsewhere += read_effort(report); }

  Effort effort_elsewhere;

 private:
  const NodeWork& work_;
  const NodeCandidates& candidates_;
  std::span<const OpenNode> nodes_;
  const std::int64_t upper_bound_;
  std::vector<CandidateMaker>& makers_;
  const StopCondition& stop_;
  std::span<NodeFinding> findings_;
};

/// What every node needs. A service draws the candidates again, which doesn't count where this process keeps
/// what it has drawn.
Bytes write_candidates(const CandidateSet& set, const NodeCandidates& candidates, const NodeWork& work);
/// No nodes of these candidates are to come: lets the services of the topic forget them.
Bytes write_no_candidates();

std::shared_ptr<Service> make_nodes_service(std::shared_ptr<ServedProblem> served);

}  // namespace perch
