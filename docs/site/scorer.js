// Pages come before the reference of all modules, and that before the list of changes.
var Scorer = {
  score: ([name, title, anchor, description, score]) =>
    score - (name.includes("CHANGELOG") ? 40 : name.startsWith("docs/site/modules") ? 20 : 0),
  objNameMatch: 11, objPartialMatch: 6, objPrio: { 0: 15, 1: 5, 2: -5 }, objPrioDefault: 0,
  title: 15, partialTitle: 7, term: 5, partialTerm: 2,
};
