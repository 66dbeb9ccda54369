// The syntax of Power PMAC script: program buffers, and the on-line commands of a load stream.
//
// The rules describe text after the preprocessor. Words are recognised by the class WordLexer (compiler/frontend/power_pmac), which
// cuts glued words such as ta500ts0 or X1.5Y4 and knows the declared names: the lexer below only finds where a word begins.
// A line end is white space; where it matters a predicate looks at the line numbers of two neighbouring tokens.
grammar PowerPmac;

@parser::members {
/// By token index: the token stands inside parentheses or brackets. Filled by whoever owns the token stream.
const std::vector<bool>* inside_parentheses = nullptr;

/// The next token is on the line of the token before it.
bool sameLine() { return _input->LT(1)->getLine() == _input->LT(-1)->getLine(); }

/// An expression goes on: on the same line, or on the next one inside parentheses.
bool continues() {
  const size_t index = _input->LT(1)->getTokenIndex();
  return sameLine() || (inside_parentheses && index < inside_parentheses->size() && (*inside_parentheses)[index]);
}

/// C90, R10, I1, M3 and D5 are variables where an assignment operator follows the number or the closing parenthesis.
bool assignmentFollowsNumber() {
  ssize_t next = 2;
  if (_input->LA(2) == LEFT) {
    int depth = 0;
    do {
      const size_t type = _input->LA(next++);
      if (type == antlr4::Token::EOF) return false;
      depth += type == LEFT ? 1 : type == RIGHT ? -1 : 0;
    } while (depth > 0);
  } else if (_input->LA(2) == NUMBER) {
    next = 3;
  } else {
    return false;
  }
  const size_t type = _input->LA(next);
  return (type >= ASSIGN && type <= SYNC_DECREMENT) || (type == COMMA && _input->LA(1) != LETTER_R && _input->LA(1) != LETTER_C);
}
bool startsMove() {
  switch (_input->LA(1)) {
    case AXIS: case VECTOR: return true;
    case LETTER_C: case LETTER_I: case LETTER_R: return !assignmentFollowsNumber();
    default: return false;
  }
}
bool moveFollows() { return sameLine() && startsMove(); }
bool startsCode() {
  switch (_input->LA(1)) {
    case CODE: return true;
    case LETTER_M: case LETTER_D: return !assignmentFollowsNumber();
    default: return false;
  }
}
bool startsAssignment() { return !startsMove() && !startsCode(); }
}

tokens {
  // what a WORD can turn out to be
  NAME, MEMBER, AXIS, VECTOR, CODE, VAR, LETTER_C, LETTER_D, LETTER_F, LETTER_I, LETTER_M, LETTER_N, LETTER_R,
  // keywords of both tables
  OPEN, CLOSE, PROG, PLC, SUBPROG, FORWARD, INVERSE, ROTARY, GLOBAL, CSGLOBAL, PTR, LOCAL, SUB,
  ABORT, ADISABLE, BEGIN, CMD, DDISABLE, DISABLE, DKILL, ENABLE, HOLD, HOME, HOMEZ, JOG, JOGRET, KILL, LH, PAUSE, PMATCH, RESUME,
  RUN, SEND, SENDALLCMDS, START, STEP,
  // keywords of buffers
  ABS, BREAK, BSTART, BSTOP, CALL, CALLSUB, CASE, CCALL, CCLR, CCMODE, CCR, CDEF, CEXEC, CIRCLE, CONTINUE, CSET, CSKIP, CUNDEF,
  DEFAULT, DELAY, DO, DREAD, DWELL, ELSE, FRAX, FRAX2, FREAD, GOSUB, GOTO, IF, INC, LINEAR, NOFRAX, NOFRAX2, NORMAL, PCLR, PLOAD,
  PREAD, PSET, PSTORE, PVT, RAPID, READ, RETURN, SPLINE, STOP, SWITCH, TA, TD, TM, TREAD, TS, TSD, TSEL, VREAD, WHILE,
  // keywords of on-line commands; COMMAND is one that takes no argument (r, run, q, hm, ...)
  COMMAND, ON_B, ON_J, ON_OUT, CLEAR, CX, DEFINE, DELETE, LOOKAHEAD, ECHO, OTHER_COMMAND
}

// --- a load stream --------------------------------------------------------------------------------------------------------

file : (buffer | online | ';')* EOF ;

buffer : openHeader (entryPoint | statement | ';')* CLOSE ;

openHeader
  : OPEN (kind=(PROG | PLC | SUBPROG) bufferName parameters? (',' NUMBER)*
         | kind=ROTARY NUMBER?
         | kind=(FORWARD | INVERSE) ('(' NUMBER ')' | NUMBER)?)
  ;

bufferName : NUMBER | NAME ;
parameters : '(' (parameter (',' parameter)*)? ')' ;
parameter : '&'? NAME ;
entryPoint : SUB ':' NAME parameters? ;

// --- statements of a buffer -------------------------------------------------------------------------------------------------

statement
  : block
  | ifStatement
  | whileStatement
  | doStatement
  | switchStatement
  | label
  | declaration
  | {startsMove()}? move
  | motionLine
  | {startsCode()}? codeLine
  | {startsAssignment()}? assignment
  | simpleStatement
  | onlineInBuffer
  ;

block : '{' (statement | ';')* '}' ;
body : statement | ';' ;

ifStatement : IF '(' condition ')' body elseIf* (';'? ELSE body)? ;
elseIf : ';'? ELSE IF '(' condition ')' body ;
whileStatement : WHILE '(' condition ')' body ;
doStatement : DO body ';'? WHILE '(' condition ')' ;
switchStatement : SWITCH '(' expression ')' '{' (caseLabel | statement | ';')* '}' ;
caseLabel : CASE expression ':' | DEFAULT ':' ;

/// A single = is accepted here so that it can be refused with the remedy.
condition : expression (wrong='=' expression)? ;

label : LETTER_N NUMBER ':' | LETTER_N NUMBER ;

/// What cannot stand in a buffer, accepted to be refused by name.
onlineInBuffer : '#' ({sameLine()}? ~(EOF | ';' | '}' | CLOSE | OPEN))* ;

simpleStatement
  : BREAK
  | CONTINUE
  | RETURN
  | STOP
  | kind=(GOTO | GOSUB | CALLSUB) labelNumber arguments?
  | CALL callTarget arguments?
  | READ '(' readLetter (',' readLetter)* ')'
  | kind=(DWELL | DELAY) data
  | kind=(CSET | CCLR | CEXEC | CSKIP | CCALL | CDEF | CUNDEF) data?
  | kind=(BSTART | BSTOP)
  | PSET axisWord ({sameLine()}? axisWord)*
  | kind=(PCLR | PSTORE | PLOAD | PREAD | VREAD | DREAD | FREAD | TREAD) axisList?
  | programControl
  ;

labelNumber : NUMBER | '(' expression ')' | NAME ;
callTarget : NUMBER | '(' expression ')' | NAME ('.' MEMBER)? ;
arguments : '(' (expression (',' expression)*)? ')' ;
readLetter : AXIS | VECTOR | CODE | VAR | LETTER_C | LETTER_D | LETTER_F | LETTER_I | LETTER_M | LETTER_N | LETTER_R | NAME ;

// --- motion -------------------------------------------------------------------------------------------------------------------

/// Mode and parameter words, and the move that they begin when it stands on the same line.
motionLine : motionWord ({sameLine()}? motionWord)* ({moveFollows()}? move)? ;

motionWord
  : kind=(LINEAR | RAPID)
  | kind=CIRCLE NUMBER
  | kind=(PVT | SPLINE | TSEL | CCR | TA | TD | TS | TSD | TM | LETTER_F) data
  | kind=CCMODE data
  | kind=(ABS | INC | FRAX | FRAX2 | NOFRAX | NOFRAX2) axisList?
  | kind=NORMAL vectorWord ({sameLine()}? vectorWord)*
  ;

move : moveWord ({moveFollows()}? moveWord)* ;
moveWord : axisWord | vectorWord | radiusWord ;
axisWord : (AXIS | LETTER_C) data (':' velocity=data)? ('^' trigger=data)? ;
vectorWord : (VECTOR | LETTER_I) data ;
radiusWord : LETTER_R data ;
axisList : '(' axisName (',' axisName)* ')' ;
axisName : AXIS | LETTER_C | LETTER_R | VECTOR | LETTER_I | NAME ;

codeLine : (CODE | LETTER_M | LETTER_D) data ;

/// The argument of a word: a signed constant, or an expression in parentheses. A bare variable is accepted to be refused.
data
  : sign=('+' | '-')? NUMBER
  | '(' expression ')'
  | {sameLine()}? lvalue
  ;

// --- assignments and expressions --------------------------------------------------------------------------------------------

assignment
  : lvalue operation=(ASSIGN | '+=' | '-=' | '*=' | '/=' | '%=' | '&=' | '|=' | '^=' | '>>=' | '<<='
           | SYNC_ASSIGN | '+==' | '-==' | '*==' | '/==' | '&==' | '|==' | '^==') {sameLine()}? expression (',' expression)*
  | lvalue step=('++' | '--' | '++=' | SYNC_DECREMENT)
  ;

lvalue : variable | reference ;
variable : (VAR | LETTER_C | LETTER_D | LETTER_I | LETTER_M | LETTER_R) (NUMBER | '(' expression ')') ;
reference : NAME suffix* ;
suffix : '[' expression (',' expression)* ']' | '.' MEMBER | {sameLine()}? arguments ;

expression
  : operation=('-' | '+' | '~' | '!') expression
  | expression {continues()}? operation=('*' | '/' | '%' | '&') expression
  | expression {continues()}? operation=('<<' | '>>') expression
  | expression {continues()}? operation=('+' | '-' | '|' | '^') expression
  | expression {continues()}? operation=('==' | '!=' | '<>' | '<' | '>' | '<=' | '>=' | '!>' | '!<' | '~' | '!~') expression
  | expression {continues()}? operation='&&' expression
  | expression {continues()}? operation='||' expression
  | '(' expression ')'
  | NUMBER
  | ABS '(' expression ')'
  | variable
  | reference
  | STRING
  ;

// --- declarations --------------------------------------------------------------------------------------------------------------

declaration
  : kind=(GLOBAL | CSGLOBAL | LOCAL) declarator (',' declarator)*
  | PTR pointerDeclarator (',' pointerDeclarator)*
  ;
declarator : NAME ('(' expression ')')? ('=' expression)? ;
pointerDeclarator : NAME ('(' NUMBER ')')? '->' pointerTarget ;
pointerTarget : '*' | IO_POINTER | reference ({sameLine()}? NUMBER)* ;

// --- motors, coordinate systems, programs, ports: statements that are on-line commands too ------------------------------------

programControl
  : kind=(ENABLE | DISABLE | PAUSE | RESUME | STEP) PLC numberList
  | kind=(ABORT | ADISABLE | DDISABLE | DISABLE | ENABLE | HOLD | PAUSE | RESUME | RUN | STEP | HOME | HOMEZ | KILL | DKILL) numberList?
  | kind=(BEGIN | START) startItem (',' startItem)*
  | LH direction=('\\' | '<' | '>') numberList?
  | PMATCH
  | JOG jogAction
  | JOGRET numberList? ('=' data)?
  | CMD STRING
  | SEND NUMBER? ','? STRING (',' expression)*
  | SENDALLCMDS
  ;
startItem : NUMBER (':' programName)? | ':' programName | NAME ;
programName : NUMBER | NAME ;
numberList : numberItem (',' numberItem)* ;
numberItem : NUMBER ('..' NUMBER)? | NAME | '(' expression ')' | '*' ;

jogAction
  : operation=('+' | '-' | '/') numberList?
  | numberList? operation=('=' | '==' | ':' | '^') jogDistance ('^' trigger=data)?
  ;
jogDistance : '*' | data ;

// --- on-line commands ------------------------------------------------------------------------------------------------------------

online
  : declaration
  | '#' numberList? ('->' ({sameLine()}? axisDefinition)?)?
  | '&' numberList?
  | LETTER_M NUMBER (',' NUMBER)? '->' ({sameLine()}? pointerTarget)?
  | reference '->' pointerTarget
  | assignment
  | onlineListAssignment
  | lvalue
  | CLOSE
  | DEFINE LOOKAHEAD NUMBER (',' NUMBER)?
  | DELETE LOOKAHEAD
  | CLEAR ({sameLine()}? kind=(PROG | PLC | SUBPROG) bufferName)?
  | CX ({sameLine()}? (statement | ';'))*
  | COMMAND
  | ON_B ({sameLine()}? programName)?
  | ON_J onlineJog
  | ON_OUT data
  | ECHO NUMBER?
  | '%' ({sameLine()}? data)?
  | single=('?' | '<' | '>' | '\\' | '$' | RESET)
  | OTHER_COMMAND ({sameLine()}? ~(EOF | ';'))*
  | programControl
  ;

/// First, count, step: I5213,15,100=10.
onlineListAssignment : variable ',' NUMBER (',' NUMBER)? '=' expression ;

onlineJog : operation=('+' | '-' | '/') | operation=('=' | '==' | ':' | '^') ({sameLine()}? jogDistance ('^' trigger=data)?)? ;

axisDefinition
  : LETTER_I
  | CODE ({sameLine()}? NUMBER)?
  | axisTerm ({sameLine()}? axisTerm)*
  ;
axisTerm : sign=('+' | '-')? NUMBER? axis=(AXIS | LETTER_C | NAME) | sign=('+' | '-')? NUMBER ;

// --- tokens: the assignment operators stand together, ASSIGN first and SYNC_DECREMENT last -----------------------------------------

SEMICOLON : ';' ;
COLON : ':' ;
LEFT_BRACE : '{' ;
RIGHT_BRACE : '}' ;
LEFT_BRACKET : '[' ;
RIGHT_BRACKET : ']' ;
HASH : '#' ;
AMPERSAND : '&' ;
DOT : '.' ;
ARROW : '->' ;
PLUS : '+' ;
MINUS : '-' ;
STAR : '*' ;
LEFT : '(' ;
RIGHT : ')' ;
COMMA : ',' ;
ASSIGN : '=' ;
ADD_ASSIGN : '+=' ;
SUB_ASSIGN : '-=' ;
MUL_ASSIGN : '*=' ;
DIV_ASSIGN : '/=' ;
MOD_ASSIGN : '%=' ;
AND_ASSIGN : '&=' ;
OR_ASSIGN : '|=' ;
XOR_ASSIGN : '^=' ;
SHR_ASSIGN : '>>=' ;
SHL_ASSIGN : '<<=' ;
SYNC_ASSIGN : '==' ;
SYNC_ADD : '+==' ;
SYNC_SUB : '-==' ;
SYNC_MUL : '*==' ;
SYNC_DIV : '/==' ;
SYNC_AND : '&==' ;
SYNC_OR : '|==' ;
SYNC_XOR : '^==' ;
INCREMENT : '++' ;
DECREMENT : '--' ;
SYNC_INCREMENT : '++=' ;
SYNC_DECREMENT : '--=' ;

// --- tokens ----------------------------------------------------------------------------------------------------------------------

/// u.io:$A0000C.12.1, d.user:8: every dot separates, so the whole form is one token.
IO_POINTER : [usfdiUSFDI] '.' (I O | U S E R) ([:.] (HEX | DIGIT+) ('.' DIGIT+)*)? ;

WORD : [A-Za-z_] [A-Za-z0-9_]* ;
NUMBER
  : DIGIT+ ('.' {_input->LA(1) != '.'}? DIGIT*)? EXPONENT?
  | '.' DIGIT+ EXPONENT?
  | HEX
  ;
STRING : '"' (~["\\\r\n] | '\\' ~[\r\n])* '"' ;
RANGE : '..' ;
RESET : '$$$' '***'? ;
SPACE : [ \t\r\n\f]+ -> skip ;
OTHER : . ;

fragment EXPONENT : [eE] [+-]? DIGIT+ ;
fragment HEX : '$' [0-9a-fA-F]+ ;
fragment DIGIT : [0-9] ;
fragment I : [iI] ;
fragment O : [oO] ;
fragment U : [uU] ;
fragment S : [sS] ;
fragment E : [eE] ;
fragment R : [rR] ;
