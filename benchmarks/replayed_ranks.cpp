#include "replayed_ranks.hpp"

#include <chrono>
#include <thread>
#include <vector>

#include "perch/parallel/serve.hpp"
#include "perch/parallel/team_executor.hpp"

namespace perch {
namespace {

constexpr const char* news_topic = "news";

void sleep_for(double seconds) {
  if (seconds > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

void work_for(double seconds) {
  const ThreadStopwatch watch;
  while (watch.seconds() < seconds) {
  }
}

/// Sleeps for all items of a portion at its end, since short naps take longer than is asked for.
class Sleeper final : public Service {
 public:
  explicit Sleeper(const RecordedRun& run) : run_(run) {}
  void hear(ByteReader& common, const Executor&, const StopCondition&) override {
    const auto batch = common.count();
    const bool news = common.value<bool>();
    const RecordedBatch& heard = run_.batches[batch];
    sleep_for(news ? heard.hear_news : heard.hear_common);
    batch_ = &heard;
  }
  void answer(ByteReader& question, std::size_t, const StopCondition&, ByteWriter& answer) override {
    const RecordedBatch::Item& item = batch_->items[question.count()];
    owed_ += item.answer;
    const Bytes filled(item.answer_bytes);
    answer.raw(filled.data(), filled.size());
  }
  void report(ByteWriter&) override {
    sleep_for(owed_);
    owed_ = 0.0;
  }

 private:
  const RecordedRun& run_;
  const RecordedBatch* batch_ = nullptr;
  double owed_ = 0.0;
};

class ReplayedBatch final : public Batch {
 public:
  ReplayedBatch(const RecordedRun& run, std::size_t number) : batch_(run.batches[number]), number_(number) {}
  std::size_t size() const override { return batch_.items.size(); }
  std::string topic() const override { return batch_.topic; }
  void work(std::size_t item, std::size_t) override { work_for(batch_.items[item].answer); }
  void write_common(ByteWriter& to) const override {
    to.count(number_);
    to.value(false);
    const Bytes filled(batch_.common_bytes);
    to.raw(filled.data(), filled.size());
  }
  void write_question(std::size_t item, ByteWriter& to) const override {
    to.count(item);
    const Bytes filled(batch_.items[item].question_bytes);
    to.raw(filled.data(), filled.size());
  }
  void read_answer(std::size_t item, ByteReader&) override { work_for(batch_.items[item].read); }
  double home(std::size_t item) const override { return batch_.items[item].home; }
  std::size_t grain() const override { return batch_.grain; }

 private:
  const RecordedBatch& batch_;
  std::size_t number_;
};

}  // namespace

SimulatedRun replay_ranks(const RecordedRun& run, std::size_t ranks, const Link& link) {
  LocalNetwork network(ranks, link);
  std::vector<std::thread> others;
  for (std::size_t rank = 1; rank < ranks; ++rank)
    others.emplace_back([&, rank] {
      const auto sleeper = std::make_shared<Sleeper>(run);
      Services services{{news_topic, sleeper}};
      for (const RecordedBatch& batch : run.batches) services[batch.topic] = sleeper;
      serve(network.of(rank), services, make_executor, "replay");
    });
  SimulatedRun result;
  {
    const TeamExecutor team(network.of(0), make_executor(1), 1, "replay");
    const Stopwatch watch;
    for (std::size_t b = 0; b < run.batches.size(); ++b) {
      work_for(run.batches[b].before_news);
      if (run.batches[b].news_bytes > 0) {
        ByteWriter news;
        news.count(b);
        news.value(true);
        const Bytes filled(run.batches[b].news_bytes);
        news.raw(filled.data(), filled.size());
        team.tell(news_topic, news.take());
      }
      work_for(run.batches[b].before);
      ReplayedBatch batch(run, b);
      team.spread(batch, StopCondition());
    }
    work_for(run.after);
    result.seconds = watch.seconds();
    result.messages = team.traffic().messages;
    result.bytes = team.traffic().bytes - team.traffic().news_bytes;
  }
  dismiss(network.of(0));
  for (std::thread& other : others) other.join();
  return result;
}

}  // namespace perch
