// Lints the description of the API with Redocly and Spectral: no error and no warning is allowed.
// usage: node lint.mjs OPENAPI.yaml, in one piece
import { createConfig, lint } from "@redocly/openapi-core";
import spectralCore from "@stoplight/spectral-core";
import spectralParsers from "@stoplight/spectral-parsers";
import spectralRulesets from "@stoplight/spectral-rulesets";
import { readFileSync } from "node:fs";
import { parse, stringify } from "yaml";

const file = process.argv[2];

async function redocly() {
  const config = await createConfig({
    extends: ["recommended-strict"],
    rules: {
      "no-invalid-schema-examples": "error",
      "no-invalid-parameter-examples": "error",
      "parameter-description": "error",
      "operation-description": "error",
      "tag-description": "error",
      // Signing in answers with a redirection; operation-success-response of Spectral knows that.
      "operation-2xx-response": "off",
    },
  });
  const problems = await lint({ ref: file, config });
  return problems.map((problem) => {
    const place = problem.location[0];
    return `redocly ${problem.ruleId}: ${place.pointer}: ${problem.message}`;
  });
}

async function spectral() {
  const { Document, Spectral } = spectralCore;
  const linter = new Spectral();
  linter.setRuleset({
    extends: [spectralRulesets.oas],
    rules: {
      // It takes the roles that OpenAPI 3.1 allows here for scopes, which only OAuth has.
      "oas3-operation-security-defined": "off",
    },
  });
  // The schemas of documents are left to Redocly: Spectral takes their keys for those of OpenAPI, and
  // follows them anew from every example.
  const api = parse(readFileSync(file, "utf8"));
  for (const name of ["JobDocument", "ResultDocument"]) {
    api.components.schemas[name] = { type: "object" };
  }
  const document = new Document(stringify(api), spectralParsers.Yaml, file);
  const problems = await linter.run(document);
  return problems.map((problem) => `spectral ${problem.code}: /${problem.path.join("/")}: ${problem.message}`);
}

const problems = [...(await redocly()), ...(await spectral())];
for (const problem of problems) {
  console.log(problem);
}
console.log(`${problems.length} problems in ${file}`);
process.exit(problems.length === 0 ? 0 : 1);
