#include "perch/candidates/packed_candidate.hpp"

#include "perch/observation/packed_runs.hpp"

namespace perch {
namespace {

void write_number(ByteWriter& to, std::int64_t number) {
  to.count(static_cast<std::uint64_t>(number));
}
std::int64_t read_number(ByteReader& from) {
  return static_cast<std::int64_t>(from.count());
}

}  // namespace

void write_window(ByteWriter& to, const Window& window) {
  for (const int x : {window.u0, window.v0, window.u1, window.v1}) to.value(static_cast<std::int16_t>(x));
}

Window read_window(ByteReader& from) {
  Window window;
  for (int* x : {&window.u0, &window.v0, &window.u1, &window.v1}) *x = from.value<std::int16_t>();
  return window;
}

void write_candidate(ByteWriter& to, const Candidate& candidate) {
  to.count(candidate.model);
  to.value(candidate.pose);
  write_window(to, candidate.window);
  for (const std::int64_t number :
       {candidate.explained_count, candidate.points, candidate.unexplained, candidate.exposed})
    write_number(to, number);
  for (const std::vector<Run>* runs : {&candidate.explained_runs, &candidate.certain_runs,
                                       &candidate.uncertain_runs, &candidate.explained_pixels})
    write_runs(to, *runs);
  write_runs(to, candidate.enclosed.runs());
  write_runs(to, candidate.reached.runs());
}

Candidate read_candidate(ByteReader& from) {
  Candidate candidate;
  candidate.model = from.count();
  from.read(candidate.pose);
  candidate.window = read_window(from);
  for (std::int64_t* number :
       {&candidate.explained_count, &candidate.points, &candidate.unexplained, &candidate.exposed})
    *number = read_number(from);
  for (std::vector<Run>* runs : {&candidate.explained_runs, &candidate.certain_runs,
                                 &candidate.uncertain_runs, &candidate.explained_pixels})
    *runs = read_runs(from);
  candidate.explained = PointSet(candidate.explained_runs);
  candidate.enclosed = PointSet(read_runs(from));
  candidate.reached = PointSet(read_runs(from));
  return candidate;
}

}  // namespace perch
