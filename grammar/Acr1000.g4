// The syntax of one line for an ACR1000 card, after its words have been found (ACR1000 manual, chapter 9).
//
// Blanks mean nothing to the card, so a line cannot be cut into words without knowing where commands begin: DEC10, MOVEP32 and 1 000 are
// all right. The class LineLexer (compiler/frontend/acr1000) finds the words; there are no lexer rules here.
grammar Acr1000;

tokens {
  LINE_NUMBER,          // 0 .. 65535 at the beginning of a line: the line is stored
  PARAMETER, NUMBER, HEX_NUMBER, BARE_HEX, STRING, REMARK,
  PLUS, MINUS, STAR, SLASH, COMMA, EQUALS, COLON, LEFT, RIGHT,
  VEL, ACC, DEC, STP, MOV, CIR, GOT, GSB, RET, IF, THEN, SET, CLR, PRI, POK, PEE, PBO, RUN, HAL, LIS, NEW, REN,
  STRANGE               // nothing that a line can have
}

line : LINE_NUMBER? commands? EOF ;

commands : command (COLON command)* ;

command
  : assignment | rate | move | circle | branch | conditional | relay | print | poke | peek | plain | REMARK
  ;

assignment : PARAMETER EQUALS expression ;

rate : (VEL | ACC | DEC | STP) expression ;

move : MOV SLASH? expression ;

circle : CIR rotation COMMA expression COMMA expression COMMA expression COMMA expression ;

// A sign alone is +1 or -1.
rotation : (PLUS | MINUS) | expression ;

branch : (GOT | GSB) expression ;

conditional : IF expression THEN (NUMBER | PARAMETER | HEX_NUMBER | commands) ;

relay : (SET | CLR) expression ;

print : PRI (STRING | expression)? ;

poke : POK BARE_HEX EQUALS BARE_HEX (COMMA BARE_HEX)* ;

peek : PEE BARE_HEX COMMA BARE_HEX ;

plain : RET | PBO | RUN | HAL | LIS | NEW | REN ;

// More than one operand is an extension that has to be switched on.
expression : sum ;
sum : product ((PLUS | MINUS) product)* ;
product : operand ((STAR | SLASH) operand)* ;
operand : (PLUS | MINUS)? (NUMBER | HEX_NUMBER | PARAMETER | LEFT sum RIGHT) ;
