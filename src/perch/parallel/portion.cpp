#include "perch/parallel/portion.hpp"

#include <new>
#include <stdexcept>

#include "perch/core/error.hpp"

namespace perch {

void PortionHead::write(ByteWriter& to) const {
  to.count(batch);
  to.count(number);
  to.count(news);
  to.text(topic);
  to.count(grain);
  to.value(fills_process);
  to.value(has_common);
  to.count(items);
}

PortionHead PortionHead::read(ByteReader& from) {
  PortionHead head;
  head.batch = from.count();
  head.number = from.count();
  head.news = from.count();
  head.topic = from.text();
  head.grain = from.count();
  from.read(head.fills_process);
  from.read(head.has_common);
  head.items = from.count();
  return head;
}

void AnswersHead::write(ByteWriter& to) const {
  to.count(number);
  to.value(complete);
  to.value(seconds);
}

AnswersHead AnswersHead::read(ByteReader& from) {
  AnswersHead head;
  head.number = from.count();
  from.read(head.complete);
  from.read(head.seconds);
  return head;
}

Failure Failure::current(std::uint64_t number, const std::string& process) {
  const auto failure = [&](Kind kind, const std::string& what) {
    return Failure{number, kind, process + ": " + what};
  };
  try {
    throw;
  } catch (const InputError& error) {
    return failure(Kind::input, error.what());
  } catch (const std::bad_alloc&) {
    return failure(Kind::memory, "out of memory");
  } catch (const std::exception& error) {
    return failure(Kind::internal, error.what());
  } catch (...) {
    return failure(Kind::internal, "an exception of an unknown kind");
  }
}

void Failure::raise() const {
  if (kind == Kind::input) throw InputError(what);
  if (kind == Kind::memory)
    throw InputError(what + "; use a coarser grid, smaller meshes or fewer processes a machine");
  throw std::runtime_error(what);
}

void Failure::write(ByteWriter& to) const {
  to.count(number);
  to.value(kind);
  to.text(what);
}

Failure Failure::read(ByteReader& from) {
  Failure failure;
  failure.number = from.count();
  from.read(failure.kind);
  failure.what = from.text();
  return failure;
}

}  // namespace perch
