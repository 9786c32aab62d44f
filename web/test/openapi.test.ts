// SPDX-License-Identifier: Apache-2.0
// The description of the HTTP interface is a valid OpenAPI document, and the manual shows all of it.
import { readFileSync } from 'node:fs';
import { Validator } from '@seriousme/openapi-schema-validator';
import { describe, expect, it } from 'vitest';
import { operationsMarkdown, readOpenApi, referenced } from '../manual/operations';
import { anchorOf, renderManual } from '../manual/render';

const TEXT = readFileSync(new URL('../../server/http/openapi.json', import.meta.url), 'utf8');
const API = readOpenApi();
const OPERATIONS = Object.entries(API.paths).flatMap(([path, operations]) =>
  Object.entries(operations).map(([method, operation]) => ({ method, path, operation })),
);

describe('openapi.json', () => {
  it('is a valid OpenAPI 3.1 document', async () => {
    const result = await new Validator().validate(JSON.parse(TEXT) as Record<string, unknown>);
    expect(result.errors ?? []).toEqual([]);
    expect(result.valid).toBe(true);
  });

  it('refers to components that exist, and uses each of them', () => {
    const references = new Set([...TEXT.matchAll(/"\$ref": "([^"]+)"/g)].map(([, to]) => to!));
    for (const reference of references) expect(referenced(API, reference), reference).toBeDefined();
    for (const [kind, components] of Object.entries(API.components)) {
      if (kind === 'securitySchemes') continue;
      for (const name of Object.keys(components))
        expect(references, name).toContain(`#/components/${kind}/${name}`);
    }
  });

  it('names each operation once, under a tag that exists', () => {
    const ids = OPERATIONS.map(({ operation }) => operation.operationId);
    expect(new Set(ids).size).toBe(ids.length);
    const tags = API.tags.map(({ name }) => name);
    for (const { operation } of OPERATIONS) {
      expect(operation.tags).toHaveLength(1);
      expect(tags).toContain(operation.tags[0]);
    }
  });

  it('requires only properties that it describes', () => {
    const check = (value: unknown): void => {
      if (typeof value !== 'object' || value === null) return;
      const { required, properties } = value as { required?: unknown; properties?: object };
      if (Array.isArray(required) && properties)
        for (const name of required) expect(Object.keys(properties)).toContain(name);
      Object.values(value).forEach(check);
    };
    check(API);
  });
});

describe('the reference in the manual', () => {
  const html = renderManual().get('api.html')!;

  it('has a heading for each operation and each object', () => {
    const headings = [
      ...OPERATIONS.map(({ method, path }) => `${method.toUpperCase()} ${path}`),
      ...Object.keys(API.components.schemas),
    ];
    expect(headings.length).toBeGreaterThan(90);
    for (const heading of headings)
      expect(html, heading).toContain(`<h3 id="${anchorOf(heading)}">`);
  });

  it('describes the parameters and answers of each operation', () => {
    const sections = operationsMarkdown(API).split(/^###? /m);
    for (const { method, path, operation } of OPERATIONS) {
      const heading = `\`${method.toUpperCase()} ${path}\`\n`;
      const section = sections.find((text) => text.startsWith(heading))!;
      const texts = [
        operation.summary,
        operation.description ?? '',
        operation.requestBody?.description ?? '',
        ...(operation.parameters ?? []).flatMap(({ name, description }) => [name, description]),
        ...Object.entries(operation.responses).flatMap(([status, { $ref, description }]) =>
          $ref === undefined ? [status, description] : [description],
        ),
      ];
      for (const text of texts) expect(section, heading).toContain(text ?? '');
    }
  });

  it('states right, parameters and answers of an operation', () => {
    const begin = html.indexOf('id="post-v1sessionsidprograms"');
    const section = html.slice(begin, html.indexOf('<h3', begin));
    expect(section).toContain('Right: <code>run_programs</code>');
    expect(section).toMatch(
      /<code>speed<\/code><\/td>\s*<td>query<\/td>\s*<td>number from 0.1 to 20/,
    );
    expect(section).toMatch(/<code>202<\/code><\/td>\s*<td><a href="#program">Program<\/a><\/td>/);
    expect(section).toContain('<code>bad_program</code>');
  });
});
