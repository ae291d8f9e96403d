#include "perch/parallel/team_executor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/parallel/local_network.hpp"
#include "perch/parallel/serve.hpp"

namespace perch {
namespace {

using testing::HasSubstr;

/// x + offset, the offset told to all, the factor common to a batch.
struct Sum final : Service {
  void hear(ByteReader& common, const Executor&, const StopCondition&) override {
    const auto kind = common.value<char>();
    if (kind == 'o') offset = common.value<std::uint64_t>();
    if (kind == 'f') factor = common.value<std::uint64_t>();
    if (kind == 'x') throw InputError("offset: is odd");
  }
  void answer(ByteReader& question, std::size_t worker, const StopCondition&, ByteWriter& answer) override {
    if (answered != nullptr) ++*answered;
    std::this_thread::sleep_for(nap);
    const std::uint64_t x = question.count();
    if (x == throws_at) throw InputError("x: thirteen is refused");
    last_worker = worker;
    answer.count(factor * x + offset);
  }
  void report(ByteWriter& to) override { to.count(1); }

  std::uint64_t offset = 0, factor = 1;
  std::uint64_t throws_at = std::numeric_limits<std::uint64_t>::max();
  std::chrono::microseconds nap{0};
  std::atomic<std::size_t> last_worker{0};
  std::atomic<std::size_t>* answered = nullptr;
};

class SumBatch final : public Batch {
 public:
  SumBatch(std::size_t n, std::uint64_t offset, std::uint64_t factor)
      : results(n, 0), offset_(offset), factor_(factor) {}
  std::size_t size() const override { return results.size(); }
  std::string topic() const override { return "sum"; }
  void work(std::size_t item, std::size_t) override {
    std::this_thread::sleep_for(nap);
    if (item == throws_at) throw std::runtime_error("here");
    while (waits && !given_up) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (waits) throw Interrupted();
    results[item] = factor_ * item + offset_;
  }
  void write_common(ByteWriter& to) const override {
    to.value('f');
    to.value(factor_);
  }
  void write_question(std::size_t item, ByteWriter& to) const override { to.count(item); }
  void read_answer(std::size_t item, ByteReader& from) override {
    results[item] = from.count();
    if (refuses) throw InputError("the answer is refused");
    ++elsewhere;
  }
  void read_report(ByteReader& from) override { portions += from.count(); }
  bool fills_process() const override { return fills; }
  void give_up() override { given_up = true; }

  std::vector<std::uint64_t> results;
  std::size_t elsewhere = 0, throws_at = std::numeric_limits<std::size_t>::max();
  std::uint64_t portions = 0;
  std::chrono::microseconds nap{0};
  bool fills = false, waits = false, refuses = false;
  std::atomic<bool> given_up{false};

 private:
  std::uint64_t offset_, factor_;
};

/// A first process whose others are threads.
class Team {
 public:
  explicit Team(std::size_t size, std::size_t threads = 1, const Link& link = {})
      : network_(size, link), services_(size) {
    for (std::size_t rank = 1; rank < size; ++rank) {
      services_[rank] = std::make_shared<Sum>();
      others_.emplace_back([this, rank] {
        serve(network_.of(rank), {{"sum", services_[rank]}}, make_executor, "sums");
      });
    }
    executor_ = std::make_unique<TeamExecutor>(network_.of(0), make_executor(threads), threads, "sums");
  }
  ~Team() {
    dismiss(network_.of(0));
    for (std::thread& other : others_) other.join();
  }
  const TeamExecutor& executor() const { return *executor_; }
  Sum& service(std::size_t rank) { return *services_[rank]; }
  void tell(char kind, std::uint64_t number) {
    ByteWriter to;
    to.value(kind);
    to.value(number);
    executor_->tell("sum", to.take());
  }

 private:
  LocalNetwork network_;
  std::vector<std::shared_ptr<Sum>> services_;
  std::vector<std::thread> others_;
  std::unique_ptr<TeamExecutor> executor_;
};

TEST(TeamExecutor, AnswersAsOneProcessDoes) {
  for (const std::size_t size : {1UL, 2UL, 3UL, 7UL})
    for (const std::size_t threads : {1UL, 2UL}) {
      SCOPED_TRACE(testing::Message() << size << " processes of " << threads << " threads");
      Team team(size, threads);
      EXPECT_EQ(team.executor().processes(), size);
      EXPECT_EQ(team.executor().workers(), threads);
      std::size_t elsewhere = 0;
      for (std::uint64_t round = 0; round < 20; ++round) {
        if (round % 5 == 0) team.tell('o', round / 5);
        SumBatch batch(round * round * 5, round / 5, round);
        batch.nap = std::chrono::microseconds(round == 7 ? 50 : 0);
        batch.fills = round == 3;
        ASSERT_TRUE(team.executor().spread(batch, StopCondition()));
        for (std::size_t i = 0; i < batch.size(); ++i) ASSERT_EQ(batch.results[i], round * i + round / 5);
        elsewhere += batch.elsewhere;
        EXPECT_EQ(batch.elsewhere > 0, batch.portions > 0);
      }
      EXPECT_EQ(elsewhere > 0, size > 1);
      EXPECT_EQ(team.executor().traffic().items, elsewhere);
    }
}

TEST(TeamExecutor, HearsNewsBeforeWhatBuildsOnThem) {
  // The news are large and go from process to process, the questions are small and come straight.
  Team team(8, 1, {0.0005, 5e7});
  for (std::uint64_t round = 1; round <= 3; ++round) {
    ByteWriter to;
    to.value('o');
    to.value(round);
    to.values(std::vector<double>(50000, 1.0));
    team.executor().tell("sum", to.take());
    SumBatch batch(400, round, 1);
    batch.nap = std::chrono::microseconds(200);
    ASSERT_TRUE(team.executor().spread(batch, StopCondition()));
    for (std::size_t i = 0; i < batch.size(); ++i) ASSERT_EQ(batch.results[i], i + round);
  }
}

TEST(TeamExecutor, StopsEverywhereAndGoesOn) {
  Team team(4);
  for (std::size_t rank = 1; rank < 4; ++rank) team.service(rank).nap = std::chrono::microseconds(500);
  for (int round = 0; round < 3; ++round) {
    SumBatch batch(100000, 0, 1);
    batch.nap = std::chrono::microseconds(500);
    EXPECT_FALSE(team.executor().spread(batch, StopCondition::after(0.05)));
    SumBatch next(50, 0, 2);
    ASSERT_TRUE(team.executor().spread(next, StopCondition()));
    for (std::size_t i = 0; i < next.size(); ++i) EXPECT_EQ(next.results[i], 2 * i);
  }
}

TEST(TeamExecutor, PassesOnWhatGoesWrongHereAndElsewhere) {
  Team team(3);
  for (std::size_t rank = 1; rank < 3; ++rank) {
    team.service(rank).throws_at = 13;
    team.service(rank).nap = std::chrono::microseconds(100);
  }
  SumBatch batch(26, 0, 1);
  batch.nap = std::chrono::microseconds(100000);  // the others get all but the first
  try {
    team.executor().spread(batch, StopCondition());
    ADD_FAILURE() << "no exception";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("x: thirteen is refused"));
    EXPECT_THAT(error.what(), HasSubstr("rank "));
  }
  SumBatch here(26, 0, 1);
  here.throws_at = 0;
  EXPECT_THROW(team.executor().spread(here, StopCondition()), std::runtime_error);
  team.tell('x', 0);
  SumBatch told(1000, 0, 1);
  told.nap = std::chrono::microseconds(1000);
  EXPECT_THROW(team.executor().spread(told, StopCondition()), InputError);
  SumBatch after(10, 0, 3);
  EXPECT_TRUE(team.executor().spread(after, StopCondition()));
}

TEST(TeamExecutor, PassesOnThatAnAnswerCanNotBeTakenIn) {
  Team team(3);
  SumBatch batch(100, 0, 1);
  batch.nap = std::chrono::microseconds(10000);  // the others get nearly all
  batch.refuses = true;
  EXPECT_THROW(team.executor().spread(batch, StopCondition()), InputError);
  SumBatch after(50, 0, 3);
  ASSERT_TRUE(team.executor().spread(after, StopCondition()));
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after.results[i], 3 * i);
}

TEST(TeamExecutor, GivesUpHereWhatWentWrongElsewhere) {
  Team team(2);
  team.service(1).throws_at = 13;
  SumBatch batch(26, 0, 1);
  batch.fills = true;
  batch.waits = true;  // here, until it is given up
  EXPECT_THROW(team.executor().spread(batch, StopCondition()), InputError);
  team.service(1).throws_at = 1000;
  team.service(1).nap = std::chrono::microseconds(10000);
  SumBatch stopped(1000, 0, 1);
  stopped.waits = true;
  EXPECT_FALSE(team.executor().spread(stopped, StopCondition::after(0.05)));
}

TEST(TeamExecutor, RefusesOtherPrograms) {
  LocalNetwork network(2);
  std::thread other([&] { serve(network.of(1), {}, make_executor, "sums 2"); });
  try {
    const TeamExecutor team(network.of(0), make_executor(1), 1, "sums 1");
    ADD_FAILURE() << "no exception";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "rank 1 runs sums 2, the first process sums 1; install the same program on all machines");
  }
  dismiss(network.of(0));
  other.join();
}

TEST(TeamExecutor, SpreadsWhatTakesLongOverAll) {
  Team team(4);
  std::atomic<std::size_t> answered{0};
  for (std::size_t rank = 1; rank < 4; ++rank) {
    team.service(rank).nap = std::chrono::microseconds(1000);
    team.service(rank).answered = &answered;
  }
  SumBatch batch(400, 0, 1);
  batch.nap = std::chrono::microseconds(1000);
  ASSERT_TRUE(team.executor().spread(batch, StopCondition()));
  EXPECT_EQ(batch.elsewhere, answered);
  EXPECT_GT(batch.elsewhere, 200U);  // three quarters, were all equally fast
}

}  // namespace
}  // namespace perch
