#pragma once
// A struct of facts as a read-only Python class: attributes, repr, ==, hash and pickle from one list of its fields.
#include <functional>
#include <set>

#include "tendonlab/bindings/words.hpp"

namespace tendonlab::bindings {
template <class Value>
py::object to_python(const Value& value) {
  return py::cast(value);
}
inline py::object to_python(const std::vector<std::string>& names) {
  return py::tuple(py::cast(names));
}
/// Views of texts that outlive the Python strings they came from: a pool that lives as long as the program.
inline std::string_view interned(const std::string& text) {
  static auto* pool = new std::set<std::string>;
  return *pool->insert(text).first;
}
template <class Value>
Value from_python(const py::handle& value) {
  if constexpr (std::is_same_v<Value, std::string_view>)
    return interned(value.cast<std::string>());
  else
    return value.cast<Value>();
}

/// One fact of a record, whatever its type: each record compiles its methods once, not once per fact.
template <class Record>
struct Field {
  const char *name, *meaning;
  std::function<py::object(const Record&)> get;
  std::function<void(Record&, const py::handle&)> set;
};
template <class Record, class Value>
Field<Record> field(const char* name, Value Record::*member, const char* meaning) {
  return {name, meaning, [member](const Record& of) { return to_python(of.*member); },
          [member](Record& of, const py::handle& value) { of.*member = from_python<Value>(value); }};
}
/// The value `absent` is None in Python.
template <class Record, class Value, class Absent>
Field<Record> field(const char* name, Value Record::*member, const char* meaning, Absent absent) {
  Field<Record> present = field(name, member, meaning);
  return {name, meaning,
          [member, absent, get = present.get](const Record& of) {
            return of.*member == Value(absent) ? py::object(py::none()) : get(of);
          },
          [member, absent, set = present.set](Record& of, const py::handle& value) {
            if (value.is_none())
              of.*member = Value(absent);
            else
              set(of, value);
          }};
}

template <class Record>
using Fields = std::vector<Field<Record>>;
template <class Record>
py::tuple values_of(const Fields<Record>& fields, const Record& of) {
  py::tuple all(fields.size());
  for (std::size_t i = 0; i < fields.size(); ++i) all[i] = fields[i].get(of);
  return all;
}
template <class Record>
std::string represent(const Fields<Record>& fields, const std::string& title, const Record& of) {
  std::string inside;
  for (const Field<Record>& one : fields)
    inside +=
        (inside.empty() ? "" : ", ") + std::string(one.name) + "=" + py::repr(one.get(of)).template cast<std::string>();
  return title + "(" + inside + ")";
}

template <class Record>
py::class_<Record> bind_record(py::module_& module, const char* name, const char* doc, const Fields<Record>& fields) {
  py::class_<Record> record(module, name, doc);
  for (const Field<Record>& one : fields)
    record.def_property_readonly(one.name, py::cpp_function(one.get), one.meaning);
  const auto values = [fields](const Record& of) { return values_of(fields, of); };
  record.def("__repr__", [fields, title = std::string(name)](const Record& of) { return represent(fields, title, of); })
      .def("__eq__",
           [values](const Record& of, const py::object& other) {
             return py::isinstance<Record>(other) && values(of).equal(values(other.cast<const Record&>()));
           })
      .def("__hash__", [values](const Record& of) { return py::hash(values(of)); })
      .def(py::pickle(values, [fields](const py::tuple& state) {
        Record of{};
        for (std::size_t i = 0; i < fields.size(); ++i) fields[i].set(of, state[i]);
        return of;
      }));
  return record;
}
}  // namespace tendonlab::bindings
