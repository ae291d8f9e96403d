#include "perch/tree/nodes_batch.hpp"

#include <optional>
#include <stdexcept>

#include "perch/candidates/packed_candidate.hpp"
#include "perch/tree/renderings_to_keep.hpp"

namespace perch {
namespace {

using Weight = Lagrangian::Weight;

/// What services are told.
enum class News : std::uint8_t { candidates, no_candidates, upper_bound };

/// What is told of a candidate, and what an answer holds, as bits.
enum : std::uint8_t { is_absent = 1, is_drawn = 2 };
enum : std::uint8_t { is_complete = 1, has_scene = 2, has_slots = 4 };

void write_ids(ByteWriter& to, const std::vector<CandidateId>& ids) {
  to.count(ids.size());
  for (const CandidateId id : ids) to.count(id);
}

std::vector<CandidateId> read_ids(ByteReader& from) {
  std::vector<CandidateId> ids(from.count());
  for (CandidateId& id : ids) id = static_cast<CandidateId>(from.count());
  return ids;
}

/// Ids here are numbers of NodeCandidates.
void write_finding(ByteWriter& to, const NodeFinding& finding) {
  to.value(static_cast<std::uint8_t>((finding.complete ? is_complete : 0) | (finding.found ? has_scene : 0) |
                                     (finding.slots.empty() ? 0 : has_slots)));
  to.count(static_cast<std::uint64_t>(finding.bound));
  if (finding.found) {
    to.value(finding.found->cost);
    write_ids(to, finding.found->state);
  }
  if (finding.slots.empty()) return;
  to.value(finding.base);
  for (const OpenSlot& slot : finding.slots) {
    to.count(slot.choices.size());
    Weight last = 0;
    for (const OpenSlot::Choice& choice : slot.choices) {
      to.count(choice.id);
      to.count(static_cast<std::uint64_t>(choice.reduced_cost - last));  // they ascend
      last = choice.reduced_cost;
    }
  }
}

/// \param slots what the answer doesn't repeat of them is taken from here.
NodeFinding read_finding(ByteReader& from, const std::vector<OpenSlot>& slots) {
  NodeFinding finding;
  const auto holds = from.value<std::uint8_t>();
  finding.complete = (holds & is_complete) != 0;
  finding.bound = static_cast<std::int64_t>(from.count());
  if ((holds & has_scene) != 0) {
    finding.found.emplace();
    from.read(finding.found->cost);
    finding.found->state = read_ids(from);
  }
  if ((holds & has_slots) == 0) return finding;
  from.read(finding.base);
  for (const OpenSlot& asked : slots) {
    OpenSlot slot{asked.copies, asked.origin, std::vector<OpenSlot::Choice>(from.count())};
    Weight last = 0;
    for (OpenSlot::Choice& choice : slot.choices) {
      choice.id = static_cast<CandidateId>(from.count());
      choice.reduced_cost = last += static_cast<Weight>(from.count());
    }
    finding.slots.push_back(std::move(slot));
  }
  return finding;
}

class NodesService final : public Service {
 public:
  explicit NodesService(std::shared_ptr<ServedProblem> served) : served_(std::move(served)) {}

  void hear(ByteReader& news, const Executor& executor, const StopCondition& stop) override {
    switch (news.value<News>()) {
      case News::candidates:
        hear_candidates(news, executor, stop);
        break;
      case News::no_candidates:
        told_.reset();
        break;
      case News::upper_bound:
        upper_bound_ = static_cast<std::int64_t>(news.count());
        break;
    }
  }

  void answer(ByteReader& question, std::size_t worker, const StopCondition& stop,
              ByteWriter& answer) override {
    if (!told_ || told_->version != served_->version())
      throw std::logic_error("nodes came before the candidates that they hold");
    OpenNode node;
    node.placed = read_ids(question);
    for (std::uint64_t n = question.count(); n > 0; --n) {
      OpenSlot slot;
      slot.copies = static_cast<int>(question.count());
      for (const CandidateId id : read_ids(question)) slot.choices.push_back({id, 0});
      node.slots.push_back(std::move(slot));
    }
    write_finding(answer, told_->work->work(node, upper_bound_, served_->maker(worker), stop));
  }

  void report(ByteWriter& to) override { served_->write_effort(to); }

 private:
  struct Told {
    std::uint64_t version = 0;  // of the problem
    CandidateSet set;
    std::optional<NodeWork> work;
  };

  void hear_candidates(ByteReader& news, const Executor& executor, const StopCondition& stop) {
    told_.reset();
    const LocalizationProblem& problem = served_->problem();
    auto told = std::make_unique<Told>();
    told->version = served_->version();
    told->set = CandidateSet(problem);
    RenderingsToKeep renderings;
    for (std::uint64_t n = news.count(); n > 0; --n) {
      Candidate candidate;
      candidate.model = news.count();
      const auto is = news.value<std::uint8_t>();
      candidate.absent = (is & is_absent) != 0;
      if (!candidate.absent) {
        news.read(candidate.pose);
        candidate.window = read_window(news);
        candidate.drawn_elsewhere = (is & is_drawn) != 0;
      }
      const CandidateId id = told->set.add(std::move(candidate));
      if ((is & is_drawn) != 0) renderings.add(id, told->set[id].window);
    }
    std::vector<Weight> point_weights(news.count());
    for (Weight& weight : point_weights) weight = static_cast<Weight>(news.count());
    executor.for_each(
        renderings.ids().size(),
        [&](std::size_t i, std::size_t worker) {
          Candidate& candidate = told->set[renderings.ids()[i]];
          candidate.patch = served_->maker(worker).patch(candidate);
        },
        stop);
    served_->forget_effort();
    told->work.emplace(problem, told->set, std::move(point_weights));
    told_ = std::move(told);
  }

  std::shared_ptr<ServedProblem> served_;
  std::unique_ptr<Told> told_;
  std::int64_t upper_bound_ = 0;
};

}  // namespace

NodeCandidates::NodeCandidates(const std::vector<char>& kept) : numbers(kept.size(), 0) {
  for (CandidateId id = 0; id < kept.size(); ++id) {
    if (!kept[id]) continue;
    numbers[id] = static_cast<std::uint32_t>(ids.size());
    ids.push_back(id);
  }
}

void NodesBatch::write_common(ByteWriter& common) const {
  common.value(News::upper_bound);
  common.count(static_cast<std::uint64_t>(upper_bound_));
}

void NodesBatch::write_question(std::size_t item, ByteWriter& question) const {
  const OpenNode& node = nodes_[item];
  question.count(node.placed.size());
  for (const CandidateId id : node.placed) question.count(candidates_.numbers[id]);
  question.count(node.slots.size());
  for (const OpenSlot& slot : node.slots) {
    question.count(static_cast<std::uint64_t>(slot.copies));
    question.count(slot.choices.size());
    for (const OpenSlot::Choice& choice : slot.choices) question.count(candidates_.numbers[choice.id]);
  }
}

void NodesBatch::read_answer(std::size_t item, ByteReader& answer) {
  NodeFinding finding = read_finding(answer, nodes_[item].slots);
  // Numbers ascend as ids do, so that what is sorted stays sorted.
  if (finding.found)
    for (CandidateId& id : finding.found->state) id = candidates_.ids.at(id);
  for (OpenSlot& slot : finding.slots)
    for (OpenSlot::Choice& choice : slot.choices) choice.id = candidates_.ids.at(choice.id);
  findings_[item] = std::move(finding);
}

Bytes write_candidates(const CandidateSet& set, const NodeCandidates& candidates, const NodeWork& work) {
  ByteWriter to;
  to.value(News::candidates);
  to.count(candidates.ids.size());
  for (const CandidateId id : candidates.ids) {
    const Candidate& candidate = set[id];
    const bool drawn = candidate.drawn_elsewhere || !candidate.patch.window.empty();
    to.count(candidate.model);
    to.value(static_cast<std::uint8_t>((candidate.absent ? is_absent : 0) | (drawn ? is_drawn : 0)));
    if (candidate.absent) continue;
    to.value(candidate.pose);
    write_window(to, candidate.window);
  }
  to.count(work.point_weights().size());
  for (const Weight weight : work.point_weights()) to.count(static_cast<std::uint64_t>(weight));
  return to.take();
}

Bytes write_no_candidates() {
  ByteWriter to;
  to.value(News::no_candidates);
  return to.take();
}

std::shared_ptr<Service> make_nodes_service(std::shared_ptr<ServedProblem> served) {
  return std::make_shared<NodesService>(std::move(served));
}

}  // namespace perch
